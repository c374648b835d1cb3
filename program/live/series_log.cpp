#include "program/live/series_log.h"

#include <cmath>
#include <nlohmann/json.hpp>

namespace simvis::live {
namespace {

using Json = nlohmann::ordered_json;

Json point_json(const std::pair<double, double>& point) {
  return {point.first, std::isfinite(point.second) ? Json(point.second) : Json(nullptr)};
}

}  // namespace

void SeriesLog::note(const std::string& owner, const std::string& name, const std::string& unit, bool steps,
                     double time_s, double value) {
  Series& series = series_[{owner, name}];
  series.unit = unit;
  series.steps = steps;
  if (steps && series.points.added() > 0 && series.points.last().second == value) return;
  series.points.add({time_s, value});
}

void SeriesLog::add(const ViewFrame& frame) {
  const double time_s = static_cast<double>(frame.time_ns) / 1e9;
  for (std::size_t i = 0; i < frame.values.size(); ++i) {
    const ViewParameter& parameter = frame.scene->parameters[i];
    if (parameter.removed) continue;
    note(parameter.element, parameter.name, parameter.unit, true, time_s, frame.values[i]);
  }
  for (const ViewTable& table : frame.tables) {
    if (!table.one_row || table.values.size() < table.columns.size()) continue;
    const std::string& sensor = frame.scene->sensors[table.sensor].name;
    for (std::size_t i = 0; i < table.columns.size(); ++i) {
      note(sensor, table.columns[i].name, table.columns[i].unit, false, time_s, table.values[i]);
    }
  }
}

std::string SeriesLog::message() const {
  Json all = Json::array();
  for (const auto& [place, series] : series_) {
    if (series.steps && series.points.added() < 2) continue;
    Json points = Json::array();
    for (const std::pair<double, double>& point : series.points.values()) points.push_back(point_json(point));
    all.push_back({{"owner", place.first},
                   {"name", place.second},
                   {"unit", series.unit},
                   {"steps", series.steps},
                   {"points", std::move(points)}});
  }
  return Json{{"op", "series"}, {"series", std::move(all)}}.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace simvis::live
