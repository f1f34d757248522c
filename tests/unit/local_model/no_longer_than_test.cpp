#include "forcebound/local_model/no_longer_than.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>

#include "tests/support/special_numbers.hpp"

namespace forcebound::local_model {
namespace {

using test::kInfinity;
using test::kNaN;
using Vector3 = Eigen::Vector3d;

TEST(NoLongerThan, LeavesWhatIsShorterAsItIs) {
  const Vector3 vector(3, 0, -4);
  EXPECT_EQ(no_longer_than(vector, 5), vector);
  EXPECT_EQ(no_longer_than(vector, kInfinity), vector);
}

TEST(NoLongerThan, ShortensWhatIsLongerAlongItself) {
  EXPECT_TRUE(no_longer_than(Vector3(3, 0, -4), 1).isApprox(Vector3(0.6, 0, -0.8)));
  EXPECT_EQ(no_longer_than(Vector3(3, 0, -4), 0), Vector3(Vector3::Zero()));
}

TEST(NoLongerThan, ShortensWhatIsLongerThanADoubleTooLong) {
  EXPECT_TRUE(no_longer_than(Vector3(3e200, 0, -4e200), 10).isApprox(Vector3(6, 0, -8)));
  EXPECT_TRUE(no_longer_than(Vector3(1.7e308, 1.7e308, 0), 1).isApprox(Vector3(1, 1, 0).normalized()));
}

TEST(NoLongerThan, MakesNothingFiniteThatIsNot) {
  EXPECT_FALSE(no_longer_than(Vector3(kNaN, 1, 0), 1).allFinite());
  EXPECT_FALSE(no_longer_than(Vector3(kInfinity, 1, 0), 1).allFinite());
}

}  // namespace
}  // namespace forcebound::local_model
