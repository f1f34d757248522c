#pragma once

#include <memory>
#include <stdexcept>
#include <string>

struct mjModel_;
struct mjData_;

namespace forcebound::server {

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

/// MuJoCo's own way with errors is to write MUJOCO_LOG.TXT and to end the process. Here a warning is only counted by
/// MuJoCo itself, and an error ends the call that caused it.

/// Compiles MJCF text. @param name for errors. @throws BodiesError
ModelPointer compile_mjcf(const std::string& text, const std::string& name);

/// Compiles an MJCF file, with whatever it includes. @throws BodiesError
ModelPointer load_mjcf(const std::string& path);

/// @throws BodiesError if there is not enough memory.
DataPointer make_data(const mjModel_& model);

/// One step; false if MuJoCo gave up, or reset itself because something was no number. Real time: noexcept.
bool step(const mjModel_& model, mjData_& data) noexcept;

}  // namespace forcebound::server
