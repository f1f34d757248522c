// Cost of a step of soft tissue: some 600 tetrahedra, a sphere that slides with eight contacts; beside it, in the same
// run, the cost of the same eight contacts without the precomputed compliance, each by a solve with the sparse Cholesky
// factors of all nodes, and a dense solve of their 24 coordinates alone. Build it optimised:
//
//     cmake --preset release && cmake --build --preset release --target tissue_benchmark
//     build/release/bin/tissue_benchmark

#include <benchmark/benchmark.h>

#include <Eigen/Cholesky>
#include <Eigen/SparseCholesky>
#include <cmath>

#include "forcebound/tissue/corotational_tissue.hpp"
#include "forcebound/tissue/tissue_contact.hpp"
#include "forcebound/tissue/tissue_world.hpp"
#include "tests/support/tissue_block.hpp"

namespace forcebound::tissue {
namespace {

const ElasticMaterial kSoft{.young_Pa = 5000, .poisson = 0.4};

// 5 x 5 x 4 cubes of six tetrahedra.
TetrahedralMesh mesh_of_600() { return TetrahedralMesh(test::tetrahedra_of({.cubes = {5, 5, 4}, .cube_m = 0.01})); }

LinearTissue tissue_of_600() {
  TetrahedralMesh mesh = mesh_of_600();
  const std::vector<int> held = nodes_below(mesh, scene::Point::Zero(), scene::Point::UnitZ());
  return {std::move(mesh), kSoft, held};
}

// Around in a circle of 10 mm at 1 Hz, a thousand steps a second.
void slide(benchmark::State& timing, const ProbeOptions& options, double depth_m) {
  const TissueModel model(tissue_of_600(), options);
  TissueState state{};
  double contacts = 0;
  double iterations = 0;
  double residual_m = 0;
  int n = 0;
  const auto place = [&](int step) {
    const double angle = 2e-3 * 3.14159265358979 * step;
    return scene::Point(0.025 + 0.005 * std::cos(angle), 0.025 + 0.005 * std::sin(angle),
                        0.04 + options.radius_m - depth_m);
  };
  static_cast<void>(model.step(state, place(0) + scene::Point(0, 0, depth_m + 0.001)));
  for (auto _ : timing) {
    const TissueResult result = model.step(state, place(n));
    benchmark::DoNotOptimize(result);
    contacts += result.contacts;
    iterations += result.iterations;
    residual_m = std::max(residual_m, result.residual_m);
    n = (n + 1) % 1000;
  }
  timing.counters["contacts"] = benchmark::Counter(contacts, benchmark::Counter::kAvgIterations);
  timing.counters["iterations"] = benchmark::Counter(iterations, benchmark::Counter::kAvgIterations);
  timing.counters["residual_m"] = residual_m;
}

// A cube of 40 mm of that number of tetrahedra, six in each of n^3 cubes; or the block of 600.
TetrahedralMesh mesh_of(std::int64_t tetrahedra) {
  if (tetrahedra == 600) return mesh_of_600();
  std::size_t n = 1;
  while (6 * n * n * n < static_cast<std::size_t>(tetrahedra)) ++n;
  return TetrahedralMesh(test::tetrahedra_of({.cubes = {n, n, n}, .cube_m = 0.04 / static_cast<double>(n)}));
}

void point_step(benchmark::State& timing) { slide(timing, {}, 0.004); }

void sphere_step(benchmark::State& timing) {
  slide(timing, {.radius_m = 1e-3 * static_cast<double>(timing.range(0)), .contacts_max = 16},
        1e-3 * static_cast<double>(timing.range(1)));
}

// A sphere that slides with eight contacts while others, with as many, hold the same tissue.
void sphere_step_beside(benchmark::State& timing) {
  const TissueModel model(tissue_of_600(), {.radius_m = 0.02, .contacts_max = 8});
  LinearTissueWorld world(model, 1 + static_cast<int>(timing.range(0)));
  while (world.join() >= 0) continue;
  const auto place = [&](int seat, int step) {
    const double angle = 2e-3 * 3.14159265358979 * step + seat;
    return scene::Point(0.025 + 0.005 * std::cos(angle), 0.025 + 0.005 * std::sin(angle), 0.046);
  };
  for (int seat = 0; seat <= timing.range(0); ++seat) {
    for (const double above_m : {0.02, 0.01, 0.0}) {
      world.move(seat, place(seat, 0) + scene::Point(0, 0, above_m), scene::Point::Zero());
    }
  }
  double contacts = 0;
  int n = 0;
  for (auto _ : timing) {
    world.move(0, place(0, n), scene::Point::Zero());
    contacts += world.seat(0).result.contacts;
    n = (n + 1) % 1000;
  }
  timing.counters["contacts"] = benchmark::Counter(contacts, benchmark::Counter::kAvgIterations);
}

// The same circle under large motion.
void corotational_slide(benchmark::State& timing, const CorotationalOptions& options) {
  TetrahedralMesh mesh = mesh_of(timing.range(0));
  const std::vector<int> held = nodes_below(mesh, scene::Point::Zero(), scene::Point::UnitZ());
  const CorotationalTissue tissue(std::move(mesh), kSoft, held, options);
  CorotationalBody body = tissue.make_body();
  TissueState state{};
  double iterations = 0;
  double residual_m = 0;
  int n = 0;
  const auto place = [&](int step, double depth_m) {
    const double angle = 2e-3 * 3.14159265358979 * step;
    return scene::Point(0.025 + 0.005 * std::cos(angle), 0.025 + 0.005 * std::sin(angle),
                        0.04 + options.radius_m - depth_m);
  };
  for (int step = -1; step <= 4; ++step) {
    static_cast<void>(tissue.step(state, body, place(0, 1e-3 * step)));
  }
  for (auto _ : timing) {
    const TissueResult result = tissue.step(state, body, place(n, 4e-3));
    benchmark::DoNotOptimize(result);
    iterations += result.iterations;
    residual_m = std::max(residual_m, result.residual_m);
    n = (n + 1) % 1000;
  }
  timing.counters["iterations"] = benchmark::Counter(iterations, benchmark::Counter::kAvgIterations);
  timing.counters["residual_m"] = residual_m;
}

void corotational_step(benchmark::State& timing) { corotational_slide(timing, {}); }

void corotational_sphere_step(benchmark::State& timing) {
  corotational_slide(timing, {.radius_m = 1e-3 * static_cast<double>(timing.range(1))});
}

void eight_sparse_solves(benchmark::State& timing) {
  const TetrahedralMesh mesh = mesh_of(timing.range(0));
  const FreeCoordinates free(static_cast<int>(mesh.nodes_m().size()),
                             nodes_below(mesh, scene::Point::Zero(), scene::Point::UnitZ()));
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> cholesky(free.reduced(stiffness_matrix(mesh, kSoft)));
  Eigen::MatrixXd loads = Eigen::MatrixXd::Zero(free.count(), 8);
  for (Eigen::Index contact = 0; contact < 8; ++contact) loads(free.count() - 1 - 3 * contact, contact) = 1;
  Eigen::MatrixXd moved_m = loads;
  for (auto _ : timing) {
    moved_m = cholesky.solve(loads);
    benchmark::DoNotOptimize(moved_m.data());
  }
}

void dense_solve_of_24(benchmark::State& timing) {
  const LinearTissue tissue = tissue_of_600();
  using Matrix24 = Eigen::Matrix<double, 24, 24>;
  const Matrix24 compliance =
      Matrix24(tissue.compliance_m_per_N().bottomRightCorner<24, 24>()) + 1e-4 * Matrix24::Identity();
  Eigen::Matrix<double, 24, 1> force_N = Eigen::Matrix<double, 24, 1>::Ones();
  for (auto _ : timing) {
    force_N = compliance.llt().solve(Eigen::Matrix<double, 24, 1>::Ones());
    benchmark::DoNotOptimize(force_N);
  }
}

BENCHMARK(point_step);
BENCHMARK(sphere_step)
    ->ArgNames({"radius_mm", "depth_mm"})
    ->Args({5, 3})
    ->Args({10, 4})
    ->Args({10, 8})
    ->Args({20, 4})
    ->Args({20, 10})
    ->Args({20, 14})
    ->Args({25, 14});
BENCHMARK(sphere_step_beside)->ArgNames({"others"})->DenseRange(0, 3);
BENCHMARK(corotational_step)->ArgName("tetrahedra")->Arg(162)->Arg(384)->Arg(600)->Arg(1296)->Arg(3072);
BENCHMARK(corotational_sphere_step)
    ->ArgNames({"tetrahedra", "radius_mm"})
    ->ArgsProduct({{162, 384, 600, 1296, 3072}, {8}})
    ->Args({600, 4});
BENCHMARK(eight_sparse_solves)->ArgName("tetrahedra")->Arg(162)->Arg(384)->Arg(600)->Arg(1296);
BENCHMARK(dense_solve_of_24);

}  // namespace
}  // namespace forcebound::tissue
