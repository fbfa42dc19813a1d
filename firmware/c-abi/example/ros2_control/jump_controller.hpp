// A ros2_control controller of A1's jump over saltus.h, for a hardware interface that takes (q, qd, kp, kd, tau) per joint: what a controller of your own
// may start from. Update it at 1 kHz.
//
// It has never been compiled against ROS and has never met hardware: it is compiled with shapes.hpp, and stepped by step.cpp, in `cargo xtask c-abi`.
#pragma once

#include "saltus.h"
#ifdef SALTUS_WITH_ROS
#include <controller_interface/controller_interface.hpp>
#else
#include "shapes.hpp"
#endif

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace saltus {

// What of a joint is commanded, in the order in which a command's blocks stand in saltus.h.
inline constexpr std::array<const char *, 5> COMMANDS = {"position", "velocity", "effort", "stiffness", "damping"};
inline constexpr std::size_t JOINTS = 12, FEET = 4;

class JumpController : public controller_interface::ControllerInterface {
public:
    // The file of `saltus plan`: with ROS, a parameter of the node.
    std::string plan_file;

    controller_interface::InterfaceConfiguration command_interface_configuration() const override;
    controller_interface::InterfaceConfiguration state_interface_configuration() const override;

    controller_interface::CallbackReturn on_init() override;
    // Reads the plan and makes the memory that is lent: nothing is allocated after it.
    controller_interface::CallbackReturn on_configure(const rclcpp_lifecycle::State &) override;
    // The robot stands where the plan begins; the jump follows. An interface that is missing or a joint that is elsewhere is an error.
    controller_interface::CallbackReturn on_activate(const rclcpp_lifecycle::State &) override;
    // Damps the joints.
    controller_interface::CallbackReturn on_deactivate(const rclcpp_lifecycle::State &) override;
    // Sensors, estimator, machine, commands. After a fault it goes on damping, and says OK: a robot that nobody damps falls harder.
    controller_interface::return_type update(const rclcpp::Time &time, const rclcpp::Duration &period) override;

    // Where the jump is, and why it was given up.
    const SaltusA1Tick &tick() const { return tick_; }

private:
    struct Release {
        void operator()(void *memory) const;
    };
    using Block = std::unique_ptr<void, Release>;

    double said(std::size_t state) const { return state_interfaces_[states_[state]].get_value(); }
    void observe(double period);
    void command(const SaltusA1Command &command);
    SaltusStatus arm(double now);

    std::vector<std::uint8_t> plan_;
    SaltusA1Plan about_{};
    Block machine_, estimator_;
    std::vector<std::size_t> states_, commands_;
    SaltusA1Observation seen_{};
    SaltusA1Tick tick_{};
    bool active_ = false, armed_ = false;
};

} // namespace saltus
