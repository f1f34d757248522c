#pragma once

#include <string>
#include <string_view>

namespace forcebound::ros2 {

/// A namespace as ROS 2 allows it, with a slash in front: "/left/pen"; empty for "" and "/".
/// @throws std::invalid_argument with what would be accepted
[[nodiscard]] std::string checked_namespace(std::string_view name_space);

/// The topic of DDS that is this one of ROS 2: "rt/left/measured_cp". @param name_space as checked_namespace gives it
[[nodiscard]] std::string dds_topic(std::string_view name_space, std::string_view name);

/// A topic and a type of DDS as ROS 2 calls them: "/left/measured_cp", "geometry_msgs/msg/PoseStamped". What is not
/// ROS 2's is given back, printable and cut where it is long.
[[nodiscard]] std::string ros_topic(std::string_view topic_of_dds);
[[nodiscard]] std::string ros_type(std::string_view type_of_dds);

/// The domain: `given`, else that of `environment`, which is ROS_DOMAIN_ID's value; null or empty: 0.
/// @throws std::invalid_argument with what would be accepted
[[nodiscard]] unsigned domain_of(std::string_view given, const char* environment);

}  // namespace forcebound::ros2
