#include "forcebound/server/dynamics/bodies/mujoco.hpp"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <array>
#include <csetjmp>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <new>
#include <string_view>
#include <utility>

#include "forcebound/server/dynamics/bodies/description.hpp"
#include "forcebound/server/dynamics/bodies/mjcf_check.hpp"
#include "forcebound/server/dynamics/bodies/phantom_contacts.hpp"
#include "forcebound/text/classic_locale.hpp"
#include "forcebound/text/file.hpp"
#include "forcebound/text/numbers.hpp"

namespace forcebound::server {
namespace {

// MuJoCo's handler must not return. There are two ways out. Loading is C++, whose frames hold memory: an exception
// cleans them up, and passes the C frames between, which x86-64 and arm64 compile with unwind tables (Debian's library
// has them; without, the process would end, as it would by MuJoCo's own handler). Stepping is C, with nothing to clean
// up, and must not allocate, as a throw does: a jump.
enum class WayOut { none, exception, jump };
thread_local WayOut way_out = WayOut::none;
thread_local std::jmp_buf way_back;
thread_local std::array<char, 1000> last_error{};

// The program's own handlers, if any.
void (*error_before)(const char*) = nullptr;
void (*warning_before)(const char*) = nullptr;

void leave_mujoco(const char* error) {
  if (way_out == WayOut::exception) throw BodiesError(error);
  if (way_out == WayOut::jump) {
    std::snprintf(last_error.data(), last_error.size(), "%s", error);
    std::longjmp(way_back, 1);  // NOLINT(cert-err52-cpp): the one way out of a C library
  }
  if (error_before != nullptr) return error_before(error);
  std::fprintf(stderr, "MuJoCo: %s\n", error);
  std::abort();
}

void store_warning(const char* warning) {
  if (way_out == WayOut::none && warning_before != nullptr) warning_before(warning);
}

void install_handlers() {
  static const bool kInstalled = [] {
    error_before = std::exchange(mju_user_error, leave_mujoco);
    warning_before = std::exchange(mju_user_warning, store_warning);
    leave_out_phantom_contacts();
    return true;
  }();
  (void)kInstalled;
}

/// Runs `call`, which must be pure C. False if it failed; last_error has the reason.
template <class Call>
bool completes(const Call& call) noexcept {
  static_assert(noexcept(call()), "a jump out of it must not skip destructors, and no exception may leave it");
  way_out = WayOut::jump;
  last_error.front() = '\0';
  if (setjmp(way_back) != 0) {  // NOLINT(cert-err52-cpp): see above
    way_out = WayOut::none;
    return false;
  }
  call();
  way_out = WayOut::none;
  return true;
}

[[noreturn]] void throw_last_error(const std::string& what) { throw BodiesError(what + ": " + last_error.data()); }

/// During its lifetime, MuJoCo's errors are exceptions.
class ErrorsThrow {
 public:
  ErrorsThrow() noexcept { way_out = WayOut::exception; }
  ~ErrorsThrow() { way_out = WayOut::none; }
  ErrorsThrow(const ErrorsThrow&) = delete;
  ErrorsThrow& operator=(const ErrorsThrow&) = delete;
};

std::string in_one_line(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  while (!text.empty() && text.back() == ' ') text.pop_back();
  return text;
}

struct FreeVfs {
  void operator()(mjVFS* vfs) const noexcept {
    mj_deleteVFS(vfs);
    delete vfs;  // NOLINT(cppcoreguidelines-owning-memory): this is its owner
  }
};

void check_options(const mjModel& model) {
  if (const double step_s = model.opt.timestep; !(step_s >= kTimestepLeast_s && step_s <= kTimestepMost_s)) {
    throw BodiesError("timestep must be >= " + text::to_text(kTimestepLeast_s) +
                      " and <= " + text::to_text(kTimestepMost_s) + " s, got " + text::to_text(step_s));
  }
  // RK4 would hold the external force over its four stages, which has another stability limit.
  if (model.opt.integrator == mjINT_RK4) throw BodiesError("integrator must be Euler or implicit, got RK4");
}

/// With the version, where the file may be of a newer one.
std::string with_version(std::string error) {
  const auto says = [&error](const char* words) { return error.find(words) != std::string::npos; };
  if (!says("invalid keyword") && !says("unrecognized")) return error;
  error = in_one_line(std::move(error));
  return error + "; read by MuJoCo " + mj_versionString() + ", which knows no words of newer versions";
}

ModelPointer load(const char* file, const mjVFS* files) {
  std::array<char, 1000> error{};
  ModelPointer model;
  {
    const text::ClassicLocale with_points;
    const ErrorsThrow guard;
    model.reset(mj_loadXML(file, files, error.data(), static_cast<int>(error.size())));
  }
  if (!model) throw BodiesError(with_version(error.data()));
  check_options(*model);
  const DataPointer data = make_data(*model);
  if (!step(*model, *data)) {
    const bool gave_up = last_error.front() != '\0';
    throw BodiesError(std::string("MuJoCo cannot take the first step: ") +
                      (gave_up ? last_error.data() : "the result is not finite"));
  }
  return model;
}

void check_text(const std::string& text) {
  if (text.empty()) throw BodiesError("is empty, expected <mujoco>...</mujoco>");
  check_mjcf(text);
}

/// MuJoCo's files in memory, with one file in it.
std::unique_ptr<mjVFS, FreeVfs> with_file(const char* file, std::string_view content) {
  if (content.size() > static_cast<std::size_t>(std::numeric_limits<int>::max())) {
    throw BodiesError("too large for MuJoCo");
  }
  // Room for 2000 file names: too large for a stack.
  std::unique_ptr<mjVFS, FreeVfs> files(new mjVFS);
  mj_defaultVFS(files.get());
  const int at = [&] {
    const ErrorsThrow guard;
    return mj_makeEmptyFileVFS(files.get(), file, static_cast<int>(content.size()));
  }();
  if (at != 0) throw BodiesError("too large for MuJoCo");
  std::memcpy(files->filedata[at], content.data(), content.size());
  return files;
}

ModelPointer compile_text(const std::string& text) {
  constexpr const char* kFile = "bodies.xml";
  return load(kFile, with_file(kFile, text).get());
}

/// All of a model, byte for byte.
std::string saved(const mjModel& model) {
  std::string bytes(static_cast<std::size_t>(mj_sizeModel(&model)), '\0');
  const ErrorsThrow guard;
  mj_saveModel(&model, nullptr, bytes.data(), static_cast<int>(bytes.size()));
  return bytes;
}

ModelPointer restored(const std::string& bytes) {
  constexpr const char* kFile = "bodies.mjb";
  const auto files = with_file(kFile, bytes);
  const ErrorsThrow guard;
  ModelPointer model(mj_loadModel(kFile, files.get()));
  if (!model) throw BodiesError("MuJoCo cannot read its compiled model");
  return model;
}

template <class Load>
ModelPointer named(const std::string& name, const Load& load) {
  install_handlers();
  try {
    return load();
  } catch (const BodiesError& error) {
    throw BodiesError(name + ": " + in_one_line(error.what()));
  } catch (const std::bad_alloc&) {
    throw BodiesError(name + ": needs more memory than there is");
  }
}

bool is_sound(const mjData& data) noexcept {
  return data.warning[mjWARN_BADQPOS].number == 0 && data.warning[mjWARN_BADQVEL].number == 0 &&
         data.warning[mjWARN_BADQACC].number == 0;
}

}  // namespace

void DeleteModel::operator()(mjModel_* model) const noexcept { mj_deleteModel(model); }
void DeleteData::operator()(mjData_* data) const noexcept { mj_deleteData(data); }

ModelPointer compile_mjcf(const std::string& text, const std::string& name) {
  return named(name, [&] {
    check_text(text);
    return compile_text(text);
  });
}

ModelPointer compile_foreign_mjcf(const std::string& text, const std::string& name, const child::ChildLimits& limits) {
  return named(name, [&] {
    check_text(text);
    std::string bytes;
    try {
      bytes = child::in_child([&text] { return saved(*compile_text(text)); }, limits);
    } catch (const std::runtime_error& error) {
      throw BodiesError(error.what());
    }
    return restored(bytes);
  });
}

ModelPointer load_mjcf(const std::string& path) {
  constexpr std::size_t kMjcfBytesMost = std::size_t{16} << 20U;
  std::string text;
  try {
    text = text::read_file(path, kMjcfBytesMost);
  } catch (const std::runtime_error& error) {
    throw BodiesError(error.what());
  }
  return compile_foreign_mjcf(text, path);
}

ModelPointer copy_of(const mjModel_& model) {
  install_handlers();
  mjModel* made = nullptr;
  const bool done = completes([&]() noexcept { made = mj_copyModel(nullptr, &model); });
  ModelPointer copy(made);
  if (!done) throw_last_error("MuJoCo cannot copy its model");
  if (!copy) throw BodiesError("not enough memory for a model of " + std::to_string(model.nbody) + " bodies");
  return copy;
}

void set_solver(mjModel_& model, const SolverOptions& options) noexcept {
  using Kind = SolverOptions::Kind;
  if (options.kind) {
    model.opt.solver = *options.kind == Kind::pgs ? mjSOL_PGS : *options.kind == Kind::cg ? mjSOL_CG : mjSOL_NEWTON;
  }
  if (options.iterations) model.opt.iterations = *options.iterations;
  if (options.tolerance) model.opt.tolerance = *options.tolerance;
}

SolverOptions solver_of(const mjModel_& model) noexcept {
  using Kind = SolverOptions::Kind;
  return {.kind = model.opt.solver == mjSOL_PGS  ? Kind::pgs
                  : model.opt.solver == mjSOL_CG ? Kind::cg
                                                 : Kind::newton,
          .iterations = model.opt.iterations,
          .tolerance = model.opt.tolerance};
}

DataPointer make_data(const mjModel_& model) {
  install_handlers();
  mjData* made = nullptr;
  const bool done = completes([&]() noexcept { made = mj_makeData(&model); });
  DataPointer data(made);
  if (!done) throw_last_error("MuJoCo cannot make the state of " + std::to_string(model.nbody) + " bodies");
  if (!data) throw BodiesError("not enough memory for the state of " + std::to_string(model.nbody) + " bodies");
  forward(model, *data);
  return data;
}

void forward(const mjModel_& model, mjData_& data) {
  install_handlers();
  if (!completes([&]() noexcept { mj_forward(&model, &data); }))
    throw_last_error("MuJoCo cannot compute the bodies' positions");
}

bool begin_step(const mjModel_& model, mjData_& data) noexcept {
  return completes([&]() noexcept { mj_step1(&model, &data); }) && is_sound(data);
}

bool end_step(const mjModel_& model, mjData_& data) noexcept {
  return completes([&]() noexcept { mj_step2(&model, &data); }) && is_sound(data);
}

bool step(const mjModel_& model, mjData_& data) noexcept { return begin_step(model, data) && end_step(model, data); }

bool find_dynamics(const mjModel_& model, mjData_& data) noexcept {
  return completes([&]() noexcept {
    mj_kinematics(&model, &data);
    mj_comPos(&model, &data);
    mj_crb(&model, &data);
    mj_comVel(&model, &data);
    mj_rne(&model, &data, 0, data.qfrc_bias);
  });
}

bool find_contacts(const mjModel_& model, mjData_& data) noexcept {
  return completes([&]() noexcept {
    mj_kinematics(&model, &data);
    mj_collision(&model, &data);
  });
}

}  // namespace forcebound::server
