#include "forcebound/client/commands/identify/student.hpp"

#include <gtest/gtest.h>

namespace forcebound::client::commands::identify {
namespace {

// Tables of Student's t.
TEST(StudentQuantile, IsThatOfTheTables) {
  EXPECT_NEAR(student_quantile(0.99, 10), 2.764, 0.003);
  EXPECT_NEAR(student_quantile(0.975, 5), 2.571, 0.01);
  EXPECT_NEAR(student_quantile(0.999, 30), 3.385, 0.003);
  EXPECT_NEAR(student_quantile(0.95, 1e9), 1.6449, 1e-4);
}

}  // namespace
}  // namespace forcebound::client::commands::identify
