#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

#include "forcebound/server/robot/task.hpp"

namespace forcebound::server {
namespace {

TEST(RobotsWithoutMuJoCo, AreRefusedWithTheReasonButTasksCanBeRead) {
  EXPECT_FALSE(has_simulated_robots());
  const Task task = load_task("plug");
  EXPECT_EQ(task.degrees_of_freedom, 3);
  try {
    (void)make_robot(task, 1);
    FAIL() << "made";
  } catch (const std::runtime_error& error) {
    EXPECT_EQ(std::string(error.what()).substr(0, 63),
              "task 'plug' needs a simulated robot, which needs MuJoCo, and th");
  }
}

}  // namespace
}  // namespace forcebound::server
