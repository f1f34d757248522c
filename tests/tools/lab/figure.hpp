#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

/// Figures drawn by gnuplot.
namespace forcebound::lab {

/// The same colours in all figures, distinguishable with the common colour blindnesses.
namespace colour {
inline constexpr const char* kRequest = "#b0b0b0";    // the environment's request
inline constexpr const char* kApplied = "#0b5fa5";    // applied at the device
inline constexpr const char* kLedger = "#7b4fa3";     // a law's ledger
inline constexpr const char* kAudit = "#1a8754";      // ground truth
inline constexpr const char* kNetwork = "#d9730d";    // the network's delay
inline constexpr const char* kRoundTrip = "#8c6d46";  //
inline constexpr const char* kDanger = "#c1272d";     // limits and violations
inline constexpr const char* kAxes[6] = {"#0b5fa5", "#d9730d", "#1a8754", "#7b4fa3", "#8c6d46", "#5f6b76"};

/// The laws' colours: "none" has that of danger, the others differ.
const char* of_law(const std::string& law);
}  // namespace colour

/// A curve; a y that is not finite breaks it. Both vectors have the same length.
struct Series {
  std::string label;
  std::vector<double> x{};
  std::vector<double> y{};
  const char* colour = colour::kApplied;
  double width = 1.6;
  enum class Mark : std::uint8_t { none, dot, ring, cross };  ///< of each point; rings and crosses have no curve
  Mark mark = Mark::none;
  bool joined = true;                ///< dots have a curve through them
  std::vector<std::string> names{};  ///< of its points, to stand beside them; none, or as many as points
};

/// A horizontal line to compare with, such as a limit.
struct Reference {
  double y = 0;
  std::string label;
};

/// One diagram: its y axis carries quantity and unit.
struct Panel {
  std::string title;
  std::string y_label;
  std::vector<Series> series{};
  std::vector<Reference> references{};
  std::optional<double> y_min{};  ///< otherwise from the data
  std::optional<double> y_max{};
  bool y_log = false;
  std::optional<double> y_linear_to{};  ///< linear up to this much above and below zero, logarithmic beyond
};

/// Panels one below the other, with the same x axis.
struct Figure {
  std::string title;
  std::string subtitle{};
  std::string x_label = "time [s]";
  std::vector<Panel> panels{};
  bool x_log = false;
  std::vector<std::string> x_names{};  ///< of the places 1, 2, ... along x, if that is what they are: then no numbers
};

/// Cuts a panel's axis at 1.5 times its usual maximum if there are larger values: force at hardly any depth is a spike
/// of stiffness that would hide all the rest. The title says if it is cut.
void cut_spikes(Panel& panel, double usual_most, double most);

/// Draws a PNG of 1400 pixels width.
/// @throws std::runtime_error if the file cannot be written, or naming the package when gnuplot is missing.
void draw(const Figure& figure, const std::filesystem::path& png);

/// The same for a gnuplot script that writes `png`.
void draw_script(const std::string& script, const std::filesystem::path& png);

/// A string as gnuplot reads it, whatever is in it.
[[nodiscard]] std::string gnuplot_string(const std::string& text);

/// Thins a curve of any length to at most 2000 columns with nothing that stands out lost: each column keeps its lowest
/// and its highest point.
///
/// `add` allocates nothing, so it may be fed from a sink.
class Envelope {
 public:
  Envelope() { columns_.reserve(2 * kColumns); }

  /// @param x must not decrease; a y that is not finite breaks the curve.
  void add(double x, double y) noexcept;

  [[nodiscard]] bool empty() const noexcept { return columns_.empty(); }

  [[nodiscard]] Series series(std::string label, const char* colour) const;

 private:
  struct Point {
    double x;
    double y;
  };
  struct Column {
    Point low;
    Point high;
    bool gap;  ///< the curve is broken before it
  };
  static constexpr std::size_t kColumns = 2000;

  enum class Gaps { kept, closed };
  void halve() noexcept;
  void merge_pairs(Gaps gaps) noexcept;

  std::vector<Column> columns_;
  std::size_t per_column_ = 1;
  std::size_t in_last_ = 0;
  bool gap_ = false;
};

}  // namespace forcebound::lab
