// Times a law over recorded rows in C++, beside which benchmark.py sets the same law and rows in Python.
//
//     law_rows DEVICE LAW FILE [TIMES]
//
// FILE has float64 rows of positions and requests, as many of each as the device has axes. Prints the nanoseconds of
// processor time per tick of each of TIMES runs, a line each, and at last the sum of all forces, so that both sides can
// compare.

#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <exception>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <vector>

#include "forcebound/baselines/baselines.hpp"
#include "forcebound/control/force_bounder.hpp"
#include "forcebound/device/load_device.hpp"

namespace {

namespace control = forcebound::control;

std::vector<double> numbers_of(const std::string& file) {
  std::ifstream in(file, std::ios::binary | std::ios::ate);
  if (!in) throw std::runtime_error(file + ": cannot be read");
  std::vector<double> numbers(static_cast<std::size_t>(in.tellg()) / sizeof(double));
  in.seekg(0);
  in.read(reinterpret_cast<char*>(numbers.data()), static_cast<std::streamsize>(numbers.size() * sizeof(double)));
  return numbers;
}

/// What Python gets too: a force, an energy and xi for each row.
struct Steps {
  std::vector<double> forces_N;
  std::vector<double> energies_J;
  std::vector<double> xis;
};

Steps steps_of(const control::DeviceFacts& facts, const std::string& law, const std::vector<double>& numbers) {
  const Eigen::Index dof = facts.degrees_of_freedom();
  const auto rows = numbers.size() / static_cast<std::size_t>(2 * dof);
  control::ForceBounder bounder(facts, forcebound::baselines::shipped_laws().make(law, facts));
  const control::Damping damping = control::Damping::from_matrix(facts.damping);
  control::Motion motion;
  motion.jacobian = control::Matrix::Identity(dof, dof);
  motion.damping = &damping;
  motion.latency_s = motion.latency_s_max = facts.latency_s;
  Steps steps{std::vector<double>(rows * static_cast<std::size_t>(dof)), std::vector<double>(rows),
              std::vector<double>(rows)};
  const double* at = numbers.data();
  double* force_at = steps.forces_N.data();
  for (std::size_t row = 0; row < rows; ++row) {
    motion.interval_s = row == 0 ? 0 : facts.period_s;
    motion.position = motion.joint = control::Vector::Map(at, dof);
    const control::Vector request_N = control::Vector::Map(at + dof, dof);
    at += 2 * dof;
    const control::Vector force_N = bounder.tick(motion, request_N);
    for (const double component_N : force_N) *force_at++ = component_N;
    steps.energies_J[row] = bounder.law().energy_J();
    steps.xis[row] = bounder.law().xi();
  }
  return steps;
}

}  // namespace

int main(int argc, char** argv) try {
  const std::vector<std::string> arguments(argv, argv + argc);
  if (argc < 4) throw std::invalid_argument("expected DEVICE LAW FILE [TIMES]");
  const control::DeviceFacts facts = forcebound::device::load_device(arguments[1]).facts;
  const std::vector<double> numbers = numbers_of(arguments[3]);
  const int times = argc > 4 ? std::stoi(arguments[4]) : 1;
  double sum_N = 0;
  for (int i = 0; i < times; ++i) {
    const std::clock_t begin = std::clock();
    const Steps steps = steps_of(facts, arguments[2], numbers);
    const double took_ns = 1e9 * static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
    std::printf("%.3f\n", took_ns / static_cast<double>(steps.energies_J.size()));
    sum_N = 0;
    for (const double force_N : steps.forces_N) sum_N += force_N;
  }
  std::printf("%.17g\n", sum_N);
  return EXIT_SUCCESS;
} catch (const std::exception& error) {
  std::fprintf(stderr, "law_rows: %s\n", error.what());
  return EXIT_FAILURE;
}
