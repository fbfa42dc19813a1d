// Steps the controller as ros2_control's manager would, on a robot that stands as the plan begins and is seen standing there all the time, beside the same calls
// of saltus.h without it. Ends with 0 if both command the same bits in every phase, and if what can go wrong ends in damping.
//
//   step PLAN.bin
#include "jump_controller.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iterator>
#include <map>

using controller_interface::CallbackReturn;
using controller_interface::return_type;
using saltus::JOINTS;

namespace {

int failures = 0;

void hold(const char *what, bool holds) {
    if (!holds) {
        std::printf("wrong: %s\n", what);
        ++failures;
    }
}

// Hardware that lends whatever it is asked for, in another order.
struct Robot {
    std::map<std::string, double> states, commands;

    void lend(saltus::JumpController &controller) {
        const auto wanted = controller.state_interface_configuration().names, told = controller.command_interface_configuration().names;
        for (const std::string &name : wanted) {
            states[name];
        }
        for (const std::string &name : told) {
            commands[name] = std::nan("");
        }
        controller.state_interfaces_.clear();
        controller.command_interfaces_.clear();
        for (auto &[name, value] : states) {
            controller.state_interfaces_.emplace_back(name, &value);
        }
        for (auto &[name, value] : commands) {
            controller.command_interfaces_.emplace_back(name, &value);
        }
    }

    // As the plan begins, its weight on four feet.
    void stand(const SaltusA1Plan &plan, const std::vector<std::string> &names) {
        for (auto &[name, value] : states) {
            value = 0;
        }
        for (std::size_t i = 0; i < JOINTS; ++i) {
            states[names[i]] = plan.start_joints[i];
        }
        states["imu/linear_acceleration.z"] = 9.81;
        for (const char *leg : {"FL", "FR", "RL", "RR"}) {
            states[std::string(leg) + "_foot/force.z"] = plan.weight / 4;
        }
    }

    bool is_damped() const {
        return std::all_of(commands.begin(), commands.end(), [](const auto &one) {
            const bool damping = one.first.find("/damping") != std::string::npos;
            return damping ? one.second > 0 : one.second == 0;
        });
    }
};

// The commands of saltus.h itself, of a robot that stands still.
struct Beside {
    std::vector<std::uint8_t> plan;
    SaltusA1Plan about{};
    alignas(16) unsigned char machine[64 * 1024], estimator[8 * 1024];
    SaltusA1Tick tick{};
    double torques[JOINTS] = {0};

    void begin() {
        SaltusA1Start start{};
        start.imu_orientation_bi[3] = 1;
        std::memcpy(start.position_w, about.start_position_w, sizeof start.position_w);
        std::memcpy(start.orientation_wb, about.start_orientation_wb, sizeof start.orientation_wb);
        std::memcpy(start.joints, about.start_joints, sizeof start.joints);
        saltus_a1_estimator_init(estimator, sizeof estimator, SALTUS_VERSION, &start);
        saltus_a1_machine_init(machine, sizeof machine, SALTUS_VERSION);
    }

    void update(double now, bool arms) {
        SaltusA1Sample sample{};
        SaltusA1Observation seen{};
        SaltusA1Estimate found{};
        sample.specific_force_i[2] = 9.81;
        std::memcpy(sample.joints, about.start_joints, sizeof sample.joints);
        std::memcpy(seen.joints, about.start_joints, sizeof seen.joints);
        std::memcpy(seen.torques, torques, sizeof seen.torques);
        std::fill(std::begin(sample.evidence), std::end(sample.evidence), 1.0);
        std::fill(std::begin(seen.foot_forces), std::end(seen.foot_forces), about.weight / 4);
        saltus_a1_estimator_update(estimator, &sample, 1e-3, &found);
        std::memcpy(seen.position_w, found.position_w, sizeof seen.position_w);
        std::memcpy(seen.orientation_wb, found.orientation_wb, sizeof seen.orientation_wb);
        std::memcpy(seen.linear_velocity_b, found.linear_velocity_b, sizeof seen.linear_velocity_b);
        std::memcpy(seen.angular_velocity_b, found.angular_velocity_b, sizeof seen.angular_velocity_b);
        saltus_a1_machine_tick(machine, now, &seen, &tick);
        if (arms) {
            saltus_a1_machine_arm(machine, plan.data(), plan.size(), now + 1.2, nullptr);
        }
    }
};

Beside beside;

bool same_bits(const Robot &robot, const std::vector<std::string> &names, const SaltusA1Command &command) {
    const double *const blocks[] = {command.position, command.velocity, command.feed_forward, command.stiffness, command.damping};
    for (std::size_t i = 0; i < names.size(); ++i) {
        if (std::memcmp(&robot.commands.at(names[i]), &blocks[i / JOINTS][i % JOINTS], sizeof(double)) != 0) {
            return false;
        }
    }
    return true;
}

} // namespace

int main(int count, char **words) {
    const rclcpp_lifecycle::State state{};
    const rclcpp::Duration period(1e-3);
    saltus::JumpController controller;
    Robot robot;
    hold("init", controller.on_init() == CallbackReturn::SUCCESS);
    hold("no plan is no configuration", controller.on_configure(state) == CallbackReturn::FAILURE);
    controller.plan_file = count > 1 ? words[1] : "";
    hold("configure", controller.on_configure(state) == CallbackReturn::SUCCESS);
    hold("no update before it is active", controller.update(rclcpp::Time(0), period) == return_type::ERROR);
    hold("no activation without a robot", controller.on_activate(state) == CallbackReturn::ERROR);

    std::ifstream file(controller.plan_file, std::ios::binary);
    beside.plan.assign(std::istreambuf_iterator<char>(file), {});
    hold("plan", saltus_a1_plan_read(beside.plan.data(), beside.plan.size(), &beside.about, nullptr) == SALTUS_STATUS_OK);
    const auto names = controller.command_interface_configuration().names;
    robot.lend(controller);
    robot.stand(beside.about, controller.state_interface_configuration().names);
    hold("activate", controller.on_activate(state) == CallbackReturn::SUCCESS);
    beside.begin();
    int visited[SALTUS_PHASE_ABORT + 1] = {0};
    for (int k = 1; 1e-3 * k < 1.2 + beside.about.touchdown + 0.2; ++k) {
        const double now = 1e-3 * k;
        hold("update", controller.update(rclcpp::Time(now), period) == return_type::OK);
        beside.update(now, k == 1);
        hold("the same bits as of saltus.h", same_bits(robot, names, beside.tick.command));
        ++visited[controller.tick().phase];
        if (controller.tick().phase == SALTUS_PHASE_HOLD) {
            // Of a robot that stands: with any others its feet would not be believed.
            std::memcpy(beside.torques, beside.tick.command.feed_forward, sizeof beside.torques);
            for (std::size_t i = 0; i < JOINTS; ++i) {
                robot.states[names[i].substr(0, names[i].find('/')) + "/effort"] = beside.torques[i];
            }
        }
    }
    for (int phase = SALTUS_PHASE_HOLD; phase <= SALTUS_PHASE_LANDING; ++phase) {
        hold(saltus_phase_text(static_cast<std::uint32_t>(phase)), visited[phase] > 0);
    }
    hold("no fault", visited[SALTUS_PHASE_ABORT] == 0);

    // Again, with an encoder that fails in the hold; and once more, until it is deactivated.
    hold("activate again", controller.on_activate(state) == CallbackReturn::SUCCESS);
    controller.update(rclcpp::Time(100.001), period);
    robot.states["FR_thigh_joint/position"] = std::nan("");
    for (int k = 2; k < 10; ++k) {
        hold("damping is OK", controller.update(rclcpp::Time(100 + 1e-3 * k), period) == return_type::OK);
    }
    hold("a broken encoder", controller.tick().fault == SALTUS_FAULT_JOINT && controller.tick().fault_index == 4 && robot.is_damped());
    robot.stand(beside.about, controller.state_interface_configuration().names);
    hold("activate after a fault", controller.on_activate(state) == CallbackReturn::SUCCESS);
    controller.update(rclcpp::Time(200.001), period);
    controller.update(rclcpp::Time(200.002), period);
    hold("it holds", controller.tick().phase == SALTUS_PHASE_HOLD && !robot.is_damped());
    controller.on_deactivate(state);
    hold("deactivated, it damps", robot.is_damped());
    std::puts(failures == 0 ? "ros2_control: every phase commands the bits of saltus.h" : "ros2_control: FAILED");
    return failures == 0 ? 0 : 1;
}
