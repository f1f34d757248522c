#pragma once

#include <memory>
#include <string>

#include "forcebound/child/in_child.hpp"
#include "forcebound/server/dynamics/bodies/bodies_error.hpp"

struct mjModel_;
struct mjData_;
struct mjContact_;

namespace forcebound::server {

struct SolverOptions;

// By default MuJoCo reports errors by writing MUJOCO_LOG.TXT and ending the process. With these functions a warning is
// only counted by MuJoCo itself, and an error ends the call that caused it.
//
// MuJoCo has one handler of errors and one of warnings for the whole process. The first call from here replaces them
// permanently. Errors in a program's own calls of MuJoCo are passed on to the handlers that were there before; without
// one a warning is dropped, and an error ends the process. A program that installs a handler later must handle the
// errors here too: MuJoCo expects it not to return.
//
// MuJoCo's collision of boxes is replaced for the whole process as well: see phantom_contacts.hpp.
//
// Any thread may call these functions, each with data of its own, and several may compile at once: in MuJoCo 2.2.2
// compilations share only the last model's XML, behind a lock of MuJoCo's own; its error handler and locale are
// thread-local.

struct DeleteModel {
  void operator()(mjModel_* model) const noexcept;
};
struct DeleteData {
  void operator()(mjData_* data) const noexcept;
};
using ModelPointer = std::unique_ptr<mjModel_, DeleteModel>;
using DataPointer = std::unique_ptr<mjData_, DeleteData>;

/// Compiles MJCF text of our own, which check_mjcf accepts. @param name for errors. @throws BodiesError
ModelPointer compile_mjcf(const std::string& text, const std::string& name);

/// The same model from the text of others, on which MuJoCo may crash or never end: see child::in_child. @throws
/// BodiesError
ModelPointer compile_foreign_mjcf(const std::string& text, const std::string& name,
                                  const child::ChildLimits& limits = {});

/// The same from a file, of at most 16 MiB. @throws BodiesError
ModelPointer load_mjcf(const std::string& path);

/// @throws BodiesError if there is not enough memory.
ModelPointer copy_of(const mjModel_& model);

/// Sets `options` in the model; the rest stays.
void set_solver(mjModel_& model, const SolverOptions& options) noexcept;

/// All solver options of the model.
SolverOptions solver_of(const mjModel_& model) noexcept;

/// The state at the model's start. @throws BodiesError, such as for too little memory.
DataPointer make_data(const mjModel_& model);

/// Recomputes all that follows from positions and velocities. @throws BodiesError
void forward(const mjModel_& model, mjData_& data);

/// A step in two halves: first all that follows from positions and velocities, so that forces can be set from it; then
/// the motion under these forces. Each is false if MuJoCo failed, or reset itself because something was not finite.
/// Real time: noexcept, no allocation.
bool begin_step(const mjModel_& model, mjData_& data) noexcept;
bool end_step(const mjModel_& model, mjData_& data) noexcept;

/// Both halves.
bool step(const mjModel_& model, mjData_& data) noexcept;

/// Finds what a motion of one's own needs, without contacts: positions of bodies and sites, the mass matrix `qM`, and
/// the forces of gravity and of velocities `qfrc_bias`. Real time as above.
bool find_dynamics(const mjModel_& model, mjData_& data) noexcept;

/// Finds the contacts at the bodies' present positions. Real time as above.
bool find_contacts(const mjModel_& model, mjData_& data) noexcept;

}  // namespace forcebound::server
