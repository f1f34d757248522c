#include "forcebound/client/app/run_parts.hpp"

#include <gtest/gtest.h>

#include <string>

#include "forcebound/baselines/baselines.hpp"
#include "tests/support/fake_device.hpp"

namespace forcebound::client {
namespace {

std::string rendering_with(const std::string& law, bool locally) {
  test::FakeDevice device(1);
  const Client::Settings settings{.server = "127.0.0.1:9", .renders_locally = locally};
  const Client client(settings, device, baselines::shipped_laws().make(law, device.facts()));
  return rendering_in_words(settings, client);
}

TEST(RenderingInWords, SaysWhyForcesAreRenderedRemotelyWhereThatWasNotChosen) {
  EXPECT_EQ(rendering_with("fba-exact", true), "local rendering");
  EXPECT_EQ(rendering_with("fba-exact", false), "remote rendering");
  EXPECT_EQ(rendering_with("wave", true), "remote rendering, as all forces go through its server-side law");
  EXPECT_EQ(rendering_with("wave", false), "remote rendering");
}

}  // namespace
}  // namespace forcebound::client
