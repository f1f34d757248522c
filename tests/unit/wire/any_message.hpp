#pragma once

#include <rapidcheck.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>
#include <variant>

#include "forcebound/wire/codec.hpp"
#include "tests/unit/wire/sample_messages.hpp"

namespace forcebound::wire {

template <class T>
T round_trip(Codec& codec, const T& message) {
  const auto decoded = codec.decode(codec.encode(message));
  if (const auto* malformed = std::get_if<Malformed>(&decoded)) {
    throw std::runtime_error("malformed " + std::to_string(static_cast<int>(*malformed)));
  }
  return std::get<T>(std::get<Message>(decoded));
}

inline rc::Gen<double> finite_number() {
  return rc::gen::suchThat(rc::gen::map(rc::gen::arbitrary<std::uint64_t>(),
                                        [](std::uint64_t bits) {
                                          double value = 0;
                                          std::memcpy(&value, &bits, sizeof value);
                                          return value;
                                        }),
                           [](double value) { return std::isfinite(value); });
}

inline control::Vector any_vector(int rows_min) {
  control::Vector v(*rc::gen::inRange(rows_min, control::kDofMax + 1));
  for (Eigen::Index i = 0; i < v.rows(); ++i) v[i] = *finite_number();
  return v;
}

inline control::ServerLawNumbers any_server_law_numbers() {
  control::ServerLawNumbers numbers(*rc::gen::inRange(0, 17));
  for (Eigen::Index i = 0; i < numbers.rows(); ++i) numbers[i] = *finite_number();
  return numbers;
}

// As far from zero as a time on the wire may be.
inline Nanoseconds any_time() {
  return Nanoseconds{*rc::gen::inRange<std::int64_t>(-kTimeMost.count(), kTimeMost.count())};
}
inline std::uint64_t any_count() { return *rc::gen::arbitrary<std::uint64_t>(); }

}  // namespace forcebound::wire
