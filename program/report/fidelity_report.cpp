#include "program/report/fidelity_report.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <vector>

#include "program/output/number_text.h"
#include "program/report/aligned_table.h"

namespace simvis {

namespace {

using Style = NumberFormat::Style;
using Row = std::vector<std::string>;
using Json = nlohmann::ordered_json;

constexpr NumberFormat kFitted{Style::general, 4};

std::string shown_number(double value) { return number_cell(kFitted, value); }

std::string interval(const FittedNumber& number) {
  return number.determined ? shown_number(number.low) + " to " + shown_number(number.high) : "not determined";
}

std::string shown_value(const FittedNumber& number) { return number.determined ? shown_number(number.value) : "-"; }

Json json_of(const FittedNumber& number) {
  if (!number.determined) return nullptr;
  return {{"value", number.value}, {"low", number.low}, {"high", number.high}};
}

std::string count_line(const FidelityReport& report) {
  std::string text;
  const auto add = [&](std::size_t count, const char* what) {
    if (count > 0) text += ", " + std::to_string(count) + " " + what;
  };
  text = "beams: " + std::to_string(report.used) + " compared";
  add(report.lost, "lost");
  add(report.at_edges, "at edges");
  add(report.grazing, "grazing");
  add(report.other_surface, "on other surfaces");
  add(report.outside, "without a surface in the scene");
  return text + "\n";
}

}  // namespace

std::string to_text(const FidelityReport& report) {
  std::string text = report.scanner + " against " + report.source + ": " + std::to_string(report.scans) +
                     (report.scans == 1 ? " scan, " : " scans, ") + std::to_string(report.beams) + " beams\n" +
                     count_line(report) + "residual: " + shown_number(report.residual_m) + " m\n\n";
  std::vector<Row> rows = {{"parameter", "value", "95 % interval", "unit", "meaning"}};
  for (const FittedParameter& each : report.parameters) {
    rows.push_back({each.name, shown_value(each.fitted), interval(each.fitted), each.unit, each.text});
  }
  text += aligned(rows);
  if (!report.rings.empty()) {
    rows = {{"ring", "azimuth deg", "95 % interval", "elevation deg", "95 % interval", "residual m", "beams"}};
    for (const FittedRing& ring : report.rings) {
      rows.push_back({std::to_string(ring.ring), shown_value(ring.azimuth_deg), interval(ring.azimuth_deg),
                      shown_value(ring.elevation_deg), interval(ring.elevation_deg), shown_number(ring.residual_m),
                      std::to_string(ring.beams)});
    }
    text += "\n" + aligned(rows);
  }
  for (const std::string& note : report.notes) text += "note: " + note + "\n";
  return text;
}

std::string to_json(const FidelityReport& report) {
  Json json = {{"scanner", report.scanner},
               {"recording", report.source},
               {"scans", report.scans},
               {"pose", report.fitted_pose ? "fitted" : "of the scene"},
               {"beams",
                {{"all", report.beams},
                 {"compared", report.used},
                 {"lost", report.lost},
                 {"at_edges", report.at_edges},
                 {"grazing", report.grazing},
                 {"other_surface", report.other_surface},
                 {"outside", report.outside}}},
               {"residual_m", report.residual_m}};
  for (const FittedParameter& each : report.parameters) {
    json["parameters"][each.name] = {{"unit", each.unit}, {"fitted", json_of(each.fitted)}};
  }
  json["rings"] = Json::array();
  for (const FittedRing& ring : report.rings) {
    json["rings"].push_back({{"ring", ring.ring},
                             {"beams", ring.beams},
                             {"azimuth_deg", json_of(ring.azimuth_deg)},
                             {"elevation_deg", json_of(ring.elevation_deg)},
                             {"residual_m", ring.residual_m}});
  }
  for (const ComparedCurve& curve : report.curves) {
    Json points = Json::array();
    for (const CurvePoint& point : curve.points)
      points.push_back({point.x, point.y, point.low, point.high, point.model});
    json["curves"][curve.name] = {{"x", curve.x_label},
                                  {"y", curve.y_label},
                                  {"columns", {"x", "y", "low", "high", "model"}},
                                  {"points", points}};
  }
  json["notes"] = report.notes;
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";  // names of topics may have any bytes
}

}  // namespace simvis
