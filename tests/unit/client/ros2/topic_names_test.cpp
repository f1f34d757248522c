#include "forcebound/client/ros2/topic_names.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

namespace forcebound::ros2 {
namespace {

TEST(TopicNames, AreThoseOfRos2OnDds) {
  EXPECT_EQ(dds_topic("", "measured_cp"), "rt/measured_cp");
  EXPECT_EQ(dds_topic(checked_namespace("/left/pen"), "servo_cf"), "rt/left/pen/servo_cf");
  EXPECT_EQ(checked_namespace("pen_2"), "/pen_2");
  EXPECT_EQ(checked_namespace("/"), "");
}

TEST(TopicNames, AreSaidAsRos2SaysThem) {
  EXPECT_EQ(ros_topic("rt/left/pen/servo_cf"), "/left/pen/servo_cf");
  EXPECT_EQ(ros_type("geometry_msgs::msg::dds_::WrenchStamped_"), "geometry_msgs/msg/WrenchStamped");
  for (const char* const other : {"Square", "a::msg::dds_::b", "::msg::_", ""}) EXPECT_EQ(ros_type(other), other);
  EXPECT_EQ(ros_type("a\nb"), "a?b");
  EXPECT_LE(ros_topic(std::string(1000, 'x')).size(), 120U);
}

TEST(TopicNames, RefuseWhatRos2Refuses) {
  for (const char* const wrong : {"a b", "/2nd", "a//b", "/a/", "a__b", "~/a", "//", "p\xc3\xa9n"}) {
    EXPECT_THROW((void)checked_namespace(wrong), std::invalid_argument) << wrong;
  }
}

TEST(TopicNames, DomainIsTheOptionsThenTheEnvironmentsThenZero) {
  EXPECT_EQ(domain_of("3", "4"), 3U);
  EXPECT_EQ(domain_of("", "4"), 4U);
  EXPECT_EQ(domain_of("", ""), 0U);
  EXPECT_EQ(domain_of("", nullptr), 0U);
  for (const char* const wrong : {"233", "-1", "x", "1.5"}) {
    EXPECT_THROW((void)domain_of(wrong, nullptr), std::invalid_argument) << wrong;
    EXPECT_THROW((void)domain_of("", wrong), std::invalid_argument) << wrong;
  }
}

}  // namespace
}  // namespace forcebound::ros2
