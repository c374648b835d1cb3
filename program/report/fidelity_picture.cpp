#include <algorithm>
#include <cmath>
#include <limits>

#include "program/output/number_text.h"
#include "program/report/fidelity_report.h"

namespace simvis {

namespace {

constexpr double kPanelWidth = 460, kPanelHeight = 270, kTitleHeight = 40;
constexpr double kLeft = 74, kRight = 14, kTop = 28, kBottom = 44;  // of the axes within a panel
constexpr int kPanelColumns = 2;
constexpr NumberFormat kPlacePx{NumberFormat::Style::fixed, 1}, kTickLabel{NumberFormat::Style::general, 6};

std::string px(double value) { return number_cell(kPlacePx, value); }

std::string escaped(const std::string& text) {
  std::string safe;
  for (const char c : text) {
    if (c == '<') {
      safe += "&lt;";
    } else if (c == '&') {
      safe += "&amp;";
    } else {
      safe += c;
    }
  }
  return safe;
}

std::string label(double x, double y, const std::string& text, const char* anchor, const char* more = "") {
  return "<text x=\"" + px(x) + "\" y=\"" + px(y) + "\" text-anchor=\"" + anchor + "\" " + more + ">" + escaped(text) +
         "</text>\n";
}

std::string line(double x0, double y0, double x1, double y1, const char* style) {
  return "<line x1=\"" + px(x0) + "\" y1=\"" + px(y0) + "\" x2=\"" + px(x1) + "\" y2=\"" + px(y1) + "\" class=\"" +
         style + "\"/>\n";
}

/// An axis from `min` to `max` with ticks at whole multiples of a step of 1, 2 or 5 times a power of ten.
struct Axis {
  double min = std::numeric_limits<double>::infinity(), max = -std::numeric_limits<double>::infinity();

  void cover(double value) {
    if (!std::isfinite(value)) return;
    min = std::min(min, value);
    max = std::max(max, value);
  }
  void widen() {
    constexpr double kMargin = 0.06;
    constexpr double kMinSpan = 1e-6;  // as a share of the values: less is rounding, and ticks have six digits
    if (!(max - min > kMinSpan * std::max(std::abs(min), std::abs(max)))) {
      const double half = std::max(std::abs(min) * kMargin, 1e-6);
      min -= half;
      max += half;
    }
    const double margin = kMargin * (max - min);
    min -= margin;
    max += margin;
  }
  double step() const {
    const double rough = (max - min) / 5, power = std::pow(10, std::floor(std::log10(rough)));
    return rough <= 2 * power ? 2 * power : rough <= 5 * power ? 5 * power : 10 * power;
  }
  double place(double value) const { return (value - min) / (max - min); }
};

class Panel {
 public:
  Panel(const ComparedCurve& curve, double left, double top)
      : curve_(curve),
        left_(left + kLeft),
        top_(top + kTop),
        right_(left + kPanelWidth - kRight),
        bottom_(top + kPanelHeight - kBottom) {
    for (const CurvePoint& point : curve.points) {
      x_.cover(point.x);
      for (const double y : {point.y, point.low, point.high, point.model}) y_.cover(y);
    }
    x_.widen();
    y_.widen();
  }

  std::string svg() const { return frame() + points() + model(); }

 private:
  double x(double value) const { return left_ + x_.place(value) * (right_ - left_); }
  double y(double value) const { return bottom_ - y_.place(value) * (bottom_ - top_); }

  std::string frame() const {
    std::string svg = label(left_, top_ - 10, curve_.name, "start", "font-weight=\"bold\"");
    // A tick that is nearly 0 by rounding is 0.
    const auto tick = [](double step, double number) { return number == 0 ? 0.0 : step * number; };
    for (double n = std::ceil(x_.min / x_.step()); n * x_.step() <= x_.max; ++n) {
      const double at = x(tick(x_.step(), n));
      svg += line(at, top_, at, bottom_, "grid") +
             label(at, bottom_ + 15, number_cell(kTickLabel, tick(x_.step(), n)), "middle");
    }
    for (double n = std::ceil(y_.min / y_.step()); n * y_.step() <= y_.max; ++n) {
      const double at = y(tick(y_.step(), n));
      svg += line(left_, at, right_, at, "grid") +
             label(left_ - 6, at + 4, number_cell(kTickLabel, tick(y_.step(), n)), "end");
    }
    svg += line(left_, bottom_, right_, bottom_, "axis") + line(left_, top_, left_, bottom_, "axis");
    svg += label((left_ + right_) / 2, bottom_ + 33, curve_.x_label, "middle");
    const std::string turn = "transform=\"rotate(-90 " + px(left_ - 60) + " " + px((top_ + bottom_) / 2) + ")\"";
    return svg + label(left_ - 60, (top_ + bottom_) / 2, curve_.y_label, "middle", turn.c_str());
  }

  std::string points() const {
    std::string svg;
    for (const CurvePoint& point : curve_.points) {
      svg += line(x(point.x), y(point.low), x(point.x), y(point.high), "interval");
      svg += "<circle cx=\"" + px(x(point.x)) + "\" cy=\"" + px(y(point.y)) + "\" r=\"2.5\" class=\"point\"/>\n";
    }
    return svg;
  }

  std::string model() const {
    std::string places;
    for (const CurvePoint& point : curve_.points) {
      if (std::isfinite(point.model)) places += px(x(point.x)) + "," + px(y(point.model)) + " ";
    }
    return "<polyline points=\"" + places + "\" class=\"model\"/>\n";
  }

  const ComparedCurve& curve_;
  double left_, top_, right_, bottom_;
  Axis x_, y_;
};

}  // namespace

std::string to_svg(const FidelityReport& report) {
  std::vector<const ComparedCurve*> curves;
  for (const ComparedCurve& curve : report.curves) {
    if (!curve.points.empty()) curves.push_back(&curve);
  }
  const auto rows = static_cast<double>((curves.size() + kPanelColumns - 1) / kPanelColumns);
  const double width = kPanelColumns * kPanelWidth, height = kTitleHeight + rows * kPanelHeight;
  std::string svg = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" + px(width) + "\" height=\"" + px(height) +
                    "\" font-family=\"sans-serif\" font-size=\"11\">\n"
                    "<style>.grid{stroke:#e0e0e0}.axis{stroke:#404040}.interval{stroke:#2166ac;stroke-width:1.2}"
                    ".point{fill:#2166ac}.model{fill:none;stroke:#b2182b;stroke-width:1.5}</style>\n"
                    "<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n";
  svg += label(kLeft, 24, report.scanner + " against " + report.source + ": measured (blue, 95 %) and fitted (red)",
               "start", "font-size=\"14\"");
  for (std::size_t i = 0; i < curves.size(); ++i) {
    const auto column = static_cast<double>(i % kPanelColumns), row = static_cast<double>(i / kPanelColumns);
    svg += Panel(*curves[i], column * kPanelWidth, kTitleHeight + row * kPanelHeight).svg();
  }
  return svg + "</svg>\n";
}

}  // namespace simvis
