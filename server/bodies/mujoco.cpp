#include "forcebound/server/bodies/mujoco.hpp"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <array>
#include <csetjmp>
#include <cstdlib>
#include <cstring>

#include "forcebound/text/numbers.hpp"

namespace forcebound::server {
namespace {

// MuJoCo's handler must not return, and an exception must not pass its C code, which has nothing to clean up: a jump.
thread_local std::jmp_buf way_back;
thread_local bool has_way_back = false;

// Shorter ones than that would be more than a motion has time for, a longer one is no haptics.
constexpr double kTimestep_s_min = 1e-4;
constexpr double kTimestep_s_max = 0.01;

[[noreturn]] void leave_mujoco(const char*) {
  if (has_way_back) std::longjmp(way_back, 1);  // NOLINT(cert-err52-cpp): the one way out of a C library
  std::abort();
}

void say_nothing(const char*) {}

struct Handlers {
  Handlers() {
    mju_user_error = leave_mujoco;
    mju_user_warning = say_nothing;
  }
};

void install_handlers() { static const Handlers kHandlers; }

/// Whether `call` came to its end. It has only plain values, since a jump runs no destructors.
template <class Call>
bool guarded(const Call& call) noexcept {
  has_way_back = true;
  bool done = false;
  if (setjmp(way_back) == 0) {  // NOLINT(cert-err52-cpp): see above
    call();
    done = true;
  }
  has_way_back = false;
  return done;
}

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

ModelPointer load(const char* file, const mjVFS* files, const std::string& name) {
  install_handlers();
  std::array<char, 1000> error{};
  mjModel* loaded = nullptr;
  // What MuJoCo had taken when it gave up is lost: an error at load, once.
  const bool done = guarded([&] { loaded = mj_loadXML(file, files, error.data(), static_cast<int>(error.size())); });
  ModelPointer model(loaded);
  if (!done) throw BodiesError(name + ": MuJoCo gave up on it, without a reason");
  if (!model) throw BodiesError(name + ": " + in_one_line(error.data()));
  if (const double step_s = model->opt.timestep; !(step_s >= kTimestep_s_min && step_s <= kTimestep_s_max)) {
    throw BodiesError(name + ": timestep must be >= " + text::to_text(kTimestep_s_min) +
                      " and <= " + text::to_text(kTimestep_s_max) + " s, got " + text::to_text(step_s));
  }
  const DataPointer data = make_data(*model);
  if (!step(*model, *data)) {
    throw BodiesError(name + ": MuJoCo cannot take the first step: expected forces and sizes that it can count with");
  }
  return model;
}

}  // namespace

void DeleteModel::operator()(mjModel_* model) const noexcept { mj_deleteModel(model); }
void DeleteData::operator()(mjData_* data) const noexcept { mj_deleteData(data); }

ModelPointer compile_mjcf(const std::string& text, const std::string& name) {
  constexpr const char* kFile = "bodies.xml";
  if (text.empty()) throw BodiesError(name + ": is empty, expected <mujoco>...</mujoco>");
  // 2000 names of files: too much for a stack.
  const std::unique_ptr<mjVFS, FreeVfs> files(new mjVFS);
  mj_defaultVFS(files.get());
  const int at = mj_makeEmptyFileVFS(files.get(), kFile, static_cast<int>(text.size()));
  if (at < 0) throw BodiesError(name + ": too large for MuJoCo");
  std::memcpy(files->filedata[at], text.data(), text.size());
  return load(kFile, files.get(), name);
}

ModelPointer load_mjcf(const std::string& path) { return load(path.c_str(), nullptr, path); }

DataPointer make_data(const mjModel_& model) {
  install_handlers();
  mjData* made = nullptr;
  (void)guarded([&] { made = mj_makeData(&model); });
  DataPointer data(made);
  if (!data) throw BodiesError("not enough memory for the state of " + std::to_string(model.nbody) + " bodies");
  if (!guarded([&] { mj_forward(&model, data.get()); })) throw BodiesError("MuJoCo cannot compute where bodies are");
  return data;
}

bool step(const mjModel_& model, mjData_& data) noexcept {
  if (!guarded([&] { mj_step(&model, &data); })) return false;
  return data.warning[mjWARN_BADQPOS].number == 0 && data.warning[mjWARN_BADQVEL].number == 0 &&
         data.warning[mjWARN_BADQACC].number == 0;
}

}  // namespace forcebound::server
