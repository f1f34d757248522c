#pragma once

#include <memory>
#include <stdexcept>
#include <string>

struct mjModel_;
struct mjData_;

namespace forcebound::server {

struct SolverOptions;

// MuJoCo's own way with errors is to write MUJOCO_LOG.TXT and to end the process. Behind these functions a warning is
// only counted by MuJoCo itself, and an error ends the call that caused it.
//
// MuJoCo has one handler of errors and one of warnings for the whole process. Ours are put in their place at the first
// call from here, for good. What comes about in a program's own calls of MuJoCo goes on to the handlers that were
// there before; without one a warning is dropped, and an error ends the process. A program that installs a handler
// later takes the errors here upon itself: MuJoCo expects of it not to return.
//
// Its collision of boxes is ours from then on as well, for the whole process: see phantom_contacts.hpp.
//
// Any thread may call these functions, each with data of its own, and several may compile at once: in MuJoCo 2.2.2
// what a compilation shares with others is the last model's XML, behind a lock of MuJoCo's own; its error handler and
// locale are the thread's.

/// Bodies that cannot be had: one line, with the file and what MuJoCo says of it.
class BodiesError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct DeleteModel {
  void operator()(mjModel_* model) const noexcept;
};
struct DeleteData {
  void operator()(mjData_* data) const noexcept;
};
using ModelPointer = std::unique_ptr<mjModel_, DeleteModel>;
using DataPointer = std::unique_ptr<mjData_, DeleteData>;

/// Compiles MJCF text. @param name for errors. @throws BodiesError
ModelPointer compile_mjcf(const std::string& text, const std::string& name);

/// Compiles an MJCF file, with whatever it includes. @throws BodiesError
ModelPointer load_mjcf(const std::string& path);

/// @throws BodiesError if there is not enough memory.
ModelPointer copy_of(const mjModel_& model);

/// What `options` say, as the model's; the rest stays.
void set_solver(mjModel_& model, const SolverOptions& options) noexcept;

/// What the model has, all of it.
SolverOptions solver_of(const mjModel_& model) noexcept;

/// Where everything is at the model's start. @throws BodiesError, such as for too little memory.
DataPointer make_data(const mjModel_& model);

/// Brings up to date all that follows from the positions and velocities. @throws BodiesError
void forward(const mjModel_& model, mjData_& data);

/// A step in two halves: first all that follows from positions and velocities, for forces to be set by it; then the
/// motion under these forces. Each is false if MuJoCo gave up, or reset itself because something was no number. Real
/// time: noexcept, no allocation.
bool begin_step(const mjModel_& model, mjData_& data) noexcept;
bool end_step(const mjModel_& model, mjData_& data) noexcept;

/// Both.
bool step(const mjModel_& model, mjData_& data) noexcept;

/// Finds what touches what as the bodies are placed now. Real time as above.
bool find_contacts(const mjModel_& model, mjData_& data) noexcept;

}  // namespace forcebound::server
