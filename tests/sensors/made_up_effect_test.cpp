// An effect of scanners and one of cameras that only this program has: one registration in one file brings the
// attribute, the column and what the effect does everywhere.
#include <doctest/doctest.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include <simvis/camera_effect.h>
#include <simvis/scan_effect.h>
#include <simvis/sensor.h>
#include <simvis/simulation.h>
#include "tests/support/error_of.h"

TEST_SUITE_BEGIN("sensors");

namespace simvis::test {
namespace {

constexpr AttributeSpec kMadeUpAttributes[] = {
    {.name = "made_up", .default_value = "0", .unit = "m", .text = "an attribute of a test", .min = 0}};

const TableColumn kMadeUpColumns[] = {
    {.name = "made_up_m", .format = "%.9g", .unit = "m", .meaning = "a channel of a test"}};

// Every range is longer by the attribute; the channel has the range before.
class MadeUpEffect : public ScanEffect {
 public:
  explicit MadeUpEffect(double longer_m) : longer_m_(longer_m) {}
  void finish(const ScanContext&, std::span<const Echo>, Scan& scan) const override {
    scan.add_channel(kMadeUpColumns[0], {scan.range_m.begin(), scan.range_m.end()});
    for (float& range_m : scan.edit_ranges().range_m) range_m += static_cast<float>(longer_m_);
  }

 private:
  double longer_m_;
};

const ScanEffectRegistration kMadeUpEffect({
    .type = {.name = "made_up",
             .summary = "An effect of a test.",
             .source = "attribute made_up above 0",
             .outputs = kShownInRanges,
             .reference = "none",
             .needs = kCastsBeams,
             .attributes = kMadeUpAttributes},
    .create = [](const ScanEffectContext& context) -> std::unique_ptr<ScanEffect> {
      const double longer_m = context.attributes.number("made_up");
      return longer_m == 0 ? nullptr : std::make_unique<MadeUpEffect>(longer_m);
    },
    .columns = kMadeUpColumns,
});

constexpr AttributeSpec kMadeUpColorAttributes[] = {
    {.name = "made_up_factor", .default_value = "1", .text = "an attribute of a test", .min = 0}};

// Red is brighter by the factor.
class MadeUpColorEffect : public CameraEffect {
 public:
  explicit MadeUpColorEffect(float factor) : factor_(factor) {}
  void post_process(const FrameTime&, const CameraLayout&, Image& color) const override {
    std::vector<float>& pixels = color.pixels.edit();
    for (std::size_t i = 0; i < pixels.size(); i += color.channels) pixels[i] *= factor_;
  }

 private:
  float factor_;
};

const CameraEffectRegistration kMadeUpColorEffect(
    {.type = {.name = "made_up_color",
              .summary = "An effect of a test.",
              .source = "attribute made_up_factor other than 1",
              .outputs = kShownInColor,
              .reference = "none",
              .needs = kHasImageSensor,
              .attributes = kMadeUpColorAttributes},
     .create = [](const CameraEffectContext& context) -> std::unique_ptr<CameraEffect> {
       const double factor = context.attributes.number("made_up_factor");
       return factor == 1 ? nullptr : std::make_unique<MadeUpColorEffect>(static_cast<float>(factor));
     }});

Simulation before_a_wall(const std::string& attributes) {
  Simulation simulation = Simulation::from_string(
      "<part name='WALL' shape='box' size='0.5 9 9' insert_at='ROOT' pose_offset='4.25 0 0 0 0 0'/>"
      "<sensor type='laser_scanner' name='S' insert_at='ROOT' samples='1' min_angle='0' max_angle='0' " +
      attributes + "/>");
  simulation.step();
  return simulation;
}

TEST_CASE("an effect of scanners is one file: its attribute, its channel and its work are there") {
  Simulation plain = before_a_wall(""), with = before_a_wall("made_up='0.5'");
  CHECK(plain.scan("S").range_m == std::vector<float>{4});
  CHECK(plain.scan("S").channels().empty());
  CHECK(with.scan("S").range_m == std::vector<float>{4.5f});
  CHECK(with.scan("S").channel("made_up_m") == std::vector<double>{4});
  const Measurement measurement = with.measurement("S");
  const MeasuredArray* const channel = measurement.find("made_up_m");
  REQUIRE(channel != nullptr);
  CHECK(channel->unit == "m");
  CHECK(channel->meaning == "a channel of a test");
  CHECK(channel->number(0) == 4);
  CHECK(contains(error_of([] { before_a_wall("made_up='-1'"); }), "attribute \"made_up\": -1 is not allowed"));
}

TEST_CASE("an effect of cameras is one file: its attribute and its work are there") {
  const auto color = [](const std::string& attributes) {
    Simulation simulation = Simulation::from_string(
        "<element type='sky' name='SKY' insert_at='ROOT' red='0.25' green='0.5' blue='0.125'/>"
        "<sensor type='camera' name='C' insert_at='ROOT' width='2' height='2' " +
        attributes + "/>");
    simulation.step();
    return simulation.color("C");
  };
  const Image plain = color(""), with = color("made_up_factor='2'");
  REQUIRE(plain.pixels.size() == 16);
  for (std::size_t i = 0; i < plain.pixels.size(); ++i) {
    CHECK(with.pixels[i] == (i % 4 == 0 ? 2 : 1) * plain.pixels[i]);
  }
  CHECK(plain.pixels[0] > 0);
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();
