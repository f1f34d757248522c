#include "forcebound/answer/answer.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "tests/support/special_numbers.hpp"
#include "tests/support/vector_of.hpp"

namespace forcebound::answer {
namespace {

using test::kNaN;
using test::vector_of;

const Answer kWhole{.force = vector_of({1, 0}),
                    .torque_N_m = vector_of({0, 0, 0.1}),
                    .contact_normal = vector_of({1, 0}),
                    .penetration_m = 1e-3,
                    .texture_N = 0.5,
                    .texture_wave = vector_of({0, 3000}),
                    .texture_across = vector_of({3000, 0}),
                    .server_parts_N = vector_of({0.5, 0})};

TEST(Answer, IsSoundWithAForceAloneAndWithAllOfIt) {
  EXPECT_TRUE(is_sound({.force = vector_of({1, 0})}, 2));
  EXPECT_TRUE(is_sound(kWhole, 2));
}

TEST(Answer, IsUnsoundWithoutAForce) { EXPECT_FALSE(is_sound({}, 2)); }

TEST(Answer, IsUnsoundWithAnotherNumberOfRows) {
  for (Vector Answer::*const vector : {&Answer::force, &Answer::torque_N_m, &Answer::contact_normal,
                                       &Answer::texture_wave, &Answer::texture_across, &Answer::server_parts_N}) {
    Answer answer = kWhole;
    answer.*vector = vector_of({0});
    EXPECT_FALSE(is_sound(answer, 2));
  }
}

TEST(Answer, IsUnsoundWithANumberThatIsNotFinite) {
  for (Vector Answer::*const vector : {&Answer::force, &Answer::torque_N_m, &Answer::contact_normal,
                                       &Answer::texture_wave, &Answer::texture_across, &Answer::server_parts_N}) {
    Answer answer = kWhole;
    (answer.*vector)[1] = kNaN;
    EXPECT_FALSE(is_sound(answer, 2));
  }
}

TEST(Answer, IsUnsoundWhereDepthOrRipplesAreNotFiniteOrBelowZero) {
  for (double Answer::*const number : {&Answer::penetration_m, &Answer::texture_N}) {
    for (const double bad : {kNaN, std::numeric_limits<double>::infinity(), -1e-9}) {
      Answer answer = kWhole;
      answer.*number = bad;
      EXPECT_FALSE(is_sound(answer, 2)) << bad;
    }
  }
}

}  // namespace
}  // namespace forcebound::answer
