// The shapes of ros2_control that jump_controller.hpp stands on, under their names, so that it compiles and is stepped without ROS: what ROS's own headers
// declare instead, where it is there. Only what a controller touches; no node, no parameters, no lifecycle but the calls.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace rclcpp {
class Duration {
public:
    explicit Duration(double seconds) : seconds_(seconds) {}
    double seconds() const { return seconds_; }

private:
    double seconds_;
};

class Time {
public:
    explicit Time(double seconds) : seconds_(seconds) {}
    double seconds() const { return seconds_; }

private:
    double seconds_;
};
} // namespace rclcpp

namespace rclcpp_lifecycle {
class State {};
} // namespace rclcpp_lifecycle

namespace hardware_interface {
class LoanedStateInterface {
public:
    LoanedStateInterface(std::string name, const double *value) : name_(std::move(name)), value_(value) {}
    const std::string &get_name() const { return name_; }
    double get_value() const { return *value_; }

private:
    std::string name_;
    const double *value_;
};

class LoanedCommandInterface {
public:
    LoanedCommandInterface(std::string name, double *value) : name_(std::move(name)), value_(value) {}
    const std::string &get_name() const { return name_; }
    void set_value(double value) { *value_ = value; }

private:
    std::string name_;
    double *value_;
};
} // namespace hardware_interface

namespace controller_interface {
enum class CallbackReturn { SUCCESS, FAILURE, ERROR };
enum class return_type { OK, ERROR };
enum class interface_configuration_type { ALL, INDIVIDUAL, NONE };

struct InterfaceConfiguration {
    interface_configuration_type type;
    std::vector<std::string> names;
};

class ControllerInterface {
public:
    virtual ~ControllerInterface() = default;
    virtual InterfaceConfiguration command_interface_configuration() const = 0;
    virtual InterfaceConfiguration state_interface_configuration() const = 0;
    virtual CallbackReturn on_init() = 0;
    virtual CallbackReturn on_configure(const rclcpp_lifecycle::State &) = 0;
    virtual CallbackReturn on_activate(const rclcpp_lifecycle::State &) = 0;
    virtual CallbackReturn on_deactivate(const rclcpp_lifecycle::State &) = 0;
    virtual return_type update(const rclcpp::Time &, const rclcpp::Duration &) = 0;

    std::vector<hardware_interface::LoanedCommandInterface> command_interfaces_;
    std::vector<hardware_interface::LoanedStateInterface> state_interfaces_;
};
} // namespace controller_interface
