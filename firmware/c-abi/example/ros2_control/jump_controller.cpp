#include "jump_controller.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <limits>

namespace saltus {
namespace {

using controller_interface::CallbackReturn;
using controller_interface::InterfaceConfiguration;
using controller_interface::interface_configuration_type;
using controller_interface::return_type;

// saltus.h's order of legs and joints, by the names of the published URDF.
constexpr std::array<const char *, FEET> LEGS = {"FL", "FR", "RL", "RR"};
constexpr std::array<const char *, 3> KINDS = {"hip", "thigh", "calf"};
// Time from arming to the start, force at which a foot is certainly loaded, and damping where nothing else is commanded: s, N, N m s/rad.
constexpr double HOLDS = 1.2, LOADED = 15.0, DAMPING = 2.0;

std::string joint(std::size_t i) {
    return std::string(LEGS[i / 3]) + "_" + KINDS[i % 3] + "_joint";
}

std::vector<std::string> command_names() {
    std::vector<std::string> names;
    for (const char *what : COMMANDS) {
        for (std::size_t i = 0; i < JOINTS; ++i) {
            names.push_back(joint(i) + "/" + what);
        }
    }
    return names;
}

// Positions, velocities and efforts of the joints; accelerometer and gyroscope; feet.
std::vector<std::string> state_names() {
    std::vector<std::string> names = command_names();
    names.resize(3 * JOINTS);
    for (const char *what : {"linear_acceleration", "angular_velocity"}) {
        for (const char *axis : {"x", "y", "z"}) {
            names.push_back(std::string("imu/") + what + "." + axis);
        }
    }
    for (const char *leg : LEGS) {
        names.push_back(std::string(leg) + "_foot/force.z");
    }
    return names;
}

// Where each of these names is among what was lent; an empty list if one is not there.
template <class Interface>
std::vector<std::size_t> places(const std::vector<std::string> &names, const std::vector<Interface> &lent) {
    std::vector<std::size_t> found;
    for (const std::string &name : names) {
        const auto at = std::find_if(lent.begin(), lent.end(), [&](const Interface &one) { return one.get_name() == name; });
        if (at == lent.end()) {
            return {};
        }
        found.push_back(static_cast<std::size_t>(at - lent.begin()));
    }
    return found;
}

void *block(std::size_t size, std::size_t align) {
    return std::aligned_alloc(align, (size + align - 1) / align * align);
}

SaltusA1Command damped() {
    SaltusA1Command command{};
    std::fill(std::begin(command.damping), std::end(command.damping), DAMPING);
    return command;
}

} // namespace

void JumpController::Release::operator()(void *memory) const {
    std::free(memory);
}

InterfaceConfiguration JumpController::command_interface_configuration() const {
    return {interface_configuration_type::INDIVIDUAL, command_names()};
}

InterfaceConfiguration JumpController::state_interface_configuration() const {
    return {interface_configuration_type::INDIVIDUAL, state_names()};
}

CallbackReturn JumpController::on_init() {
    return saltus_version() == SALTUS_VERSION ? CallbackReturn::SUCCESS : CallbackReturn::ERROR;
}

CallbackReturn JumpController::on_configure(const rclcpp_lifecycle::State &) {
    std::ifstream file(plan_file, std::ios::binary);
    plan_.assign(std::istreambuf_iterator<char>(file), {});
    if (saltus_a1_plan_read(plan_.data(), plan_.size(), &about_, nullptr) != SALTUS_STATUS_OK) {
        return CallbackReturn::FAILURE;
    }
    machine_.reset(block(saltus_a1_machine_size(), saltus_a1_machine_align()));
    estimator_.reset(block(saltus_a1_estimator_size(), saltus_a1_estimator_align()));
    return machine_ && estimator_ ? CallbackReturn::SUCCESS : CallbackReturn::ERROR;
}

CallbackReturn JumpController::on_activate(const rclcpp_lifecycle::State &) {
    states_ = places(state_names(), state_interfaces_);
    commands_ = places(command_names(), command_interfaces_);
    active_ = armed_ = false;
    if (!machine_ || states_.empty() || commands_.empty()) {
        return CallbackReturn::ERROR;
    }
    SaltusA1Start start{};
    start.imu_orientation_bi[3] = 1;
    std::copy(std::begin(about_.start_position_w), std::end(about_.start_position_w), start.position_w);
    std::copy(std::begin(about_.start_orientation_wb), std::end(about_.start_orientation_wb), start.orientation_wb);
    for (std::size_t i = 0; i < JOINTS; ++i) {
        start.joints[i] = said(i);
    }
    active_ = saltus_a1_estimator_init(estimator_.get(), saltus_a1_estimator_size(), SALTUS_VERSION, &start) == SALTUS_STATUS_OK
              && saltus_a1_machine_init(machine_.get(), saltus_a1_machine_size(), SALTUS_VERSION) == SALTUS_STATUS_OK;
    return active_ ? CallbackReturn::SUCCESS : CallbackReturn::ERROR;
}

CallbackReturn JumpController::on_deactivate(const rclcpp_lifecycle::State &) {
    if (active_) {
        command(damped());
    }
    active_ = false;
    return CallbackReturn::SUCCESS;
}

return_type JumpController::update(const rclcpp::Time &time, const rclcpp::Duration &period) {
    if (!active_) {
        return return_type::ERROR;
    }
    observe(period.seconds());
    saltus_a1_machine_tick(machine_.get(), time.seconds(), &seen_, &tick_);
    if (!armed_) {
        // Once: the machine has heard of the robot in its first tick.
        armed_ = true;
        if (arm(time.seconds()) != SALTUS_STATUS_OK) {
            command(damped());
            return return_type::ERROR;
        }
    }
    command(tick_.command);
    return return_type::OK;
}

SaltusStatus JumpController::arm(double now) {
    return saltus_a1_machine_arm(machine_.get(), plan_.data(), plan_.size(), now + HOLDS, nullptr);
}

// The robot as its sensors and the estimator have it.
void JumpController::observe(double period) {
    SaltusA1Sample sample{};
    for (std::size_t i = 0; i < JOINTS; ++i) {
        sample.joints[i] = seen_.joints[i] = said(i);
        sample.joint_velocities[i] = seen_.joint_velocities[i] = said(JOINTS + i);
        seen_.torques[i] = said(2 * JOINTS + i);
    }
    for (std::size_t i = 0; i < 3; ++i) {
        sample.specific_force_i[i] = said(3 * JOINTS + i);
        sample.angular_velocity_i[i] = said(3 * JOINTS + 3 + i);
    }
    for (std::size_t foot = 0; foot < FEET; ++foot) {
        seen_.foot_forces[foot] = said(3 * JOINTS + 6 + foot);
        sample.evidence[foot] = std::min(std::max(seen_.foot_forces[foot] / LOADED, 0.0), 1.0);
    }
    SaltusA1Estimate found{};
    saltus_a1_estimator_update(estimator_.get(), &sample, period, &found);
    std::memcpy(seen_.position_w, found.position_w, sizeof seen_.position_w);
    std::memcpy(seen_.orientation_wb, found.orientation_wb, sizeof seen_.orientation_wb);
    std::memcpy(seen_.linear_velocity_b, found.linear_velocity_b, sizeof seen_.linear_velocity_b);
    std::memcpy(seen_.angular_velocity_b, found.angular_velocity_b, sizeof seen_.angular_velocity_b);
    const bool lost = found.status == SALTUS_ESTIMATE_STATUS_LOST;
    seen_.age = lost ? std::numeric_limits<double>::infinity() : 0.0;
}

// Block by block, in the order of COMMANDS.
void JumpController::command(const SaltusA1Command &command) {
    const double *const blocks[] = {command.position, command.velocity, command.feed_forward, command.stiffness, command.damping};
    for (std::size_t i = 0; i < commands_.size(); ++i) {
        command_interfaces_[commands_[i]].set_value(blocks[i / JOINTS][i % JOINTS]);
    }
}

} // namespace saltus
