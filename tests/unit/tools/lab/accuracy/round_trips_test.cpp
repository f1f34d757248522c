#include "tests/tools/lab/accuracy/round_trips.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

namespace forcebound::lab {
namespace {

using testing::DoubleNear;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;

TEST(RoundTrips, AreInTheirUnitsOrInMilliseconds) {
  EXPECT_THAT(parse_round_trips_s({"1ms", "5", "0.02s", "500us", "0"}),
              ElementsAre(DoubleNear(0.001, 1e-12), DoubleNear(0.005, 1e-12), DoubleNear(0.02, 1e-12),
                          DoubleNear(0.0005, 1e-12), 0));
}

TEST(RoundTrips, ThatAreNoneAreNamed) {
  for (const std::string wrong : {"5m", "-1ms", "-1", "fast", "", "1ms5"}) {
    SCOPED_TRACE(wrong);
    EXPECT_THAT(
        [&] {
          static_cast<void>(parse_round_trips_s({"1ms", wrong}));
        },
        ThrowsMessage<std::invalid_argument>(
            HasSubstr("5ms, 0.02s or 500us, or bare milliseconds, got '" + wrong + "'")));
  }
}

}  // namespace
}  // namespace forcebound::lab
