#include <filesystem>
#include <stdexcept>
#include <utility>

#include "forcebound/driver/first_opening.hpp"
#include "forcebound/server/robot/driver_robot.hpp"
#include "forcebound/text/file.hpp"
#include "forcebound/text/printable.hpp"

namespace forcebound::server {
namespace {

std::unique_ptr<DriverRobot> open_once(const driver::DriverRequest& request,
                                       const std::optional<RobotDescription>& own) {
  return std::make_unique<DriverRobot>(
      std::make_shared<const driver::DriverLibrary>(request.name, request.name, driver::DriverPurpose::robot), request,
      own);
}

std::unique_ptr<DriverRobot> opened_robot(driver::DriverRequest request, const std::optional<RobotDescription>& own) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(request.name, ignored)) {
    throw std::runtime_error("driver '" + text::printable(request.name) + "': there is no such file");
  }
  // A name without a folder would be looked for where the system has its libraries.
  request.name = std::filesystem::absolute(request.name).string();
  driver::expect_to_survive(request.name, request, [&] { (void)open_once(request, own); });
  return open_once(request, own);
}

}  // namespace

std::unique_ptr<DriverRobot> open_robot(std::string_view file_and_settings) {
  driver::DriverRequest request = driver::DriverRequest::parse(file_and_settings);
  std::optional<RobotDescription> own;
  if (!request.facts_file.empty()) own = parse_robot(text::read_file(request.facts_file), request.facts_file).robot;
  return opened_robot(std::move(request), own);
}

std::unique_ptr<DriverRobot> open_robot_of_file(const std::string& file) {
  RobotFile robot = parse_robot(text::read_file(file), file);
  if (robot.driver.empty()) {
    throw std::runtime_error(file + ": robot '" + robot.robot.facts.name +
                             "': driver must be the path of its driver, FILE.so, to be driven");
  }
  driver::DriverRequest request{.name = robot.driver, .settings = robot.settings, .facts_file = file};
  return opened_robot(std::move(request), robot.robot);
}

}  // namespace forcebound::server
