#include "forcebound/server/dynamics/bodies/description.hpp"

#include "forcebound/text/numbers.hpp"

namespace forcebound::server {
namespace {

using text::to_text;

constexpr std::size_t kWeldRows = 6;

std::string numbers(const scene::Point& point) {
  return to_text(point.x()) + " " + to_text(point.y()) + " " + to_text(point.z());
}

/// Names need quotes and escapes.
std::string quoted(const std::string& name) {
  std::string text;
  for (const char c : name) {
    switch (c) {
      case '&':
        text += "&amp;";
        break;
      case '<':
        text += "&lt;";
        break;
      case '"':
        text += "&quot;";
        break;
      default:
        text += c;
    }
  }
  return "\"" + text + "\"";
}

/// A distinct name for each, and none of those of MuJoCo and of the probes.
std::string name_in_mjcf(const std::string& name) {
  const auto begins = [&](const char* with) { return name.rfind(with, 0) == 0; };
  return name == "world" || begins("probe ") || begins("body ") ? "body " + name : name;
}

std::string geometry(const BodyDescription& body) {
  const scene::Point half = 0.5 * body.size_m;
  const std::string begin = "type=\"" + body.shape + "\" size=\"";
  if (body.shape == "box") return begin + numbers(half) + "\"";
  if (body.shape == "sphere") return begin + to_text(half.x()) + "\"";
  return begin + to_text(half.x()) + "\" fromto=\"" + numbers(-body.half_axis_m) + " " + numbers(body.half_axis_m) +
         "\"";
}

std::string to_mjcf(const BodyDescription& body) {
  const bool moves = body.mass_kg > 0;
  return "    <body name=" + quoted(name_in_mjcf(body.name)) + " pos=\"" + numbers(body.position_m) + "\">" +
         (moves ? "<freejoint/>" : "") + "<geom " + geometry(body) +
         (moves ? " mass=\"" + to_text(body.mass_kg) + "\"" : "") + " friction=\"" + to_text(body.friction) +
         " 0.0001 0.00001\"/></body>\n";
}

std::string to_mjcf(const ProbeDescription& probe, int number) {
  std::string slides;
  for (const char* axis : {"1 0 0", "0 1 0", "0 0 1"})
    slides += "<joint type=\"slide\" axis=\"" + std::string(axis) + "\"/>";
  return "    <body name=\"" + name_of_probe(number) + "\">" + slides + "<geom type=\"sphere\" size=\"" +
         to_text(probe.radius_m) + "\" mass=\"" + to_text(probe.mass_kg) +
         "\" contype=\"2\" conaffinity=\"1\" priority=\"1\" solref=\"0.004 1\" solimp=\"0.95 0.99 0.001\"/></body>\n";
}

}  // namespace

std::string name_of_grasp(int number) { return "grasp " + std::to_string(number); }

std::string name_of_probe(int number) { return "probe " + std::to_string(number); }

std::string to_mjcf(const BodiesDescription& description, int probes) {
  // A box on another has four contacts, of three rows each. MuJoCo's memory grows with the square of the rows.
  const std::size_t contacts = 32 + 12 * description.bodies.size() + 8 * static_cast<std::size_t>(probes);
  std::string text =
      "<mujoco>\n  <option timestep=\"" + to_text(description.timestep_s) + "\" gravity=\"" +
      numbers(description.gravity_m_per_s2) + "\" integrator=\"implicit\" cone=\"elliptic\"/>\n  <size nconmax=\"" +
      std::to_string(contacts) + "\" njmax=\"" +
      std::to_string(3 * contacts + (description.grasp ? kWeldRows * static_cast<std::size_t>(probes) : 0)) +
      "\"/>\n"
      "  <default><geom contype=\"1\" conaffinity=\"3\" condim=\"3\" solref=\"" +
      to_text(description.contact_time_s) + " 1\"/></default>\n  <worldbody>\n";
  for (const BodyDescription& body : description.bodies) text += to_mjcf(body);
  for (int i = 0; i < probes; ++i) text += to_mjcf(description.probe, i);
  text += "  </worldbody>\n";
  if (description.grasp) {
    text += "  <equality>\n";
    for (int i = 0; i < probes; ++i) {
      text += "    <weld name=\"" + name_of_grasp(i) + "\" body1=\"" + name_of_probe(i) +
              "\" active=\"false\" solref=\"0.004 1\" solimp=\"0.95 0.99 0.001\"/>\n";
    }
    text += "  </equality>\n";
  }
  return text + "</mujoco>\n";
}

scene::Point parking_m(int probe) noexcept { return {0, 0, 1e3 + probe}; }

}  // namespace forcebound::server
