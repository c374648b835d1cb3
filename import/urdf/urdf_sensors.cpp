#include "import/urdf/urdf_sensors.h"

#include <algorithm>
#include <iterator>
#include <memory>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include <simvis/attributes.h>
#include <simvis/error.h>
#include "engine/base/words.h"
#include "import/mesh/picture_file.h"
#include "import/model/unique_names.h"
#include "import/sdf/sdf_commands.h"
#include "import/sdf/sdf_messages.h"

namespace simvis {
namespace {

// Gazebo classic makes SDF 1.7 of a URDF file.
constexpr int kSdfVersion = 7;

struct SensorPlugin {
  std::string_view file;  // part of its name
  const char* type;
};
constexpr SensorPlugin kSensorPlugins[] = {{"hector_gazebo_ros_gps", "gnss"},
                                           {"hector_gazebo_ros_imu", "imu"},
                                           {"gazebo_ros_imu", "imu"},
                                           {"hector_gazebo_ros_magnetic", "magnetometer"}};

std::set<std::string> links_of(const UrdfFile& file) {
  std::set<std::string> links;
  for (const auto& [name, link] : file.robot->links_) links.insert(name);
  return links;
}

class UrdfSensors {
 public:
  UrdfSensors(const std::shared_ptr<const UrdfSource>& source, const ImportRequest& request, ImportReport& report)
      : file_{{source, &source->file().text}, PackageFiles(request.file, request.packages), kSdfVersion},
        links_(links_of(source->file())),
        messages_(links_),
        report_(report) {}

  std::vector<std::string> commands() {
    for (const pugi::xml_node node : file_.text->document().document_element().children("gazebo")) {
      const SdfElement block(node, file_);
      const std::string link = block.attribute("reference");
      for (const SdfElement& child : block.children()) {
        if (child.tag() == "sensor") try_to([&] { add_sensor(child, link); });
        if (child.tag() == "plugin") try_to([&] { add_plugin(child); });
      }
    }
    return std::move(commands_);
  }

 private:
  // An element that is wrong is left out with a warning.
  template <class Action>
  void try_to(const Action& action) {
    try {
      action();
    } catch (const InputError& error) {
      report_.warn(without_word_error(error.what()) + "; the sensor is left out");
    }
  }

  void require_link(const std::string& link, const SdfElement& where) const {
    if (links_.contains(link)) return;
    where.fail("is a sensor of the link " + in_quotes(link) + ", which is not there");
  }

  // Names of sensors become names of files.
  SdfPlace place_of(std::string name, const std::string& link) {
    std::ranges::replace(name, '/', '_');
    std::ranges::replace(name, '.', '_');
    return {names_.add(name), link};
  }

  void add_sensor(const SdfElement& sensor, const std::string& link) {
    require_link(link, sensor);
    std::optional<std::string> command =
        sdf_sensor_command(sensor, {}, place_of(sensor.name(), link), read_sdf_pose(sensor).matrix, messages_, report_);
    if (command) commands_.push_back(std::move(*command));
  }

  void add_plugin(const SdfElement& plugin) {
    const std::string library = plugin.attribute("filename");
    const auto* const known = std::ranges::find_if(
        kSensorPlugins, [&](const SensorPlugin& each) { return library.find(each.file) != library.npos; });
    if (known == std::end(kSensorPlugins) || library.find("imu_sensor") != library.npos) return;  // no sensor
    const std::string link = plugin.child("bodyName").text();
    require_link(link, plugin);
    const SdfPlace place = place_of(plugin.name(), link);
    SdfCommand command(CommandKind::sensor, known->type, place);
    const double rate_hz = plugin.child("updateRate").number(0);
    if (rate_hz > 0) command.add("rate", rate_hz);
    add_settings(plugin, known->type, command);
    messages_.add_plugin(plugin, known->type, place, command, report_);
    commands_.push_back(command.text());
  }

  // Those of hector_gazebo_plugins, whose heading is clockwise from north, and whose noise is that of each axis.
  static void add_settings(const SdfElement& plugin, std::string_view type, SdfCommand& command) {
    struct Setting {
      const char* tag;
      const char* attribute;
    };
    constexpr Setting kPlaces[] = {
        {"referenceLatitude", "latitude"}, {"referenceLongitude", "longitude"}, {"referenceAltitude", "elevation"}};
    constexpr Setting kNoise[] = {{"accelGaussianNoise", "accelerometer_stddev"},
                                  {"rateGaussianNoise", "gyroscope_stddev"}};
    for (const Setting& each : kPlaces) {
      if (const SdfElement written = plugin.child(each.tag)) command.add(each.attribute, written.number(0));
    }
    if (type == "gnss") command.add("heading", 90 - plugin.child("referenceHeading").number(0));
    for (const Setting& each : kNoise) {
      const std::string written = plugin.child(each.tag).text();  // one number, or one for each axis
      const std::vector<std::string_view> numbers = words_of(written);
      double stddev = 0;
      if (type != "imu" || numbers.empty()) continue;
      if (!parse_number(numbers.front(), stddev)) plugin.fail("has a noise that is no number: " + in_quotes(written));
      command.add(each.attribute, stddev);
    }
  }

  SdfFile file_;
  std::set<std::string> links_;
  SdfMessages messages_;
  UniqueNames names_;
  ImportReport& report_;
  std::vector<std::string> commands_;
};

}  // namespace

std::vector<std::string> urdf_sensor_commands(const std::shared_ptr<const UrdfSource>& source,
                                              const ImportRequest& request, ImportReport& report) {
  return UrdfSensors(source, request, report).commands();
}

}  // namespace simvis
