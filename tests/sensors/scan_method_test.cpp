// The method of a laser scanner: the written one, the default, and errors.
#include <doctest/doctest.h>

#include <algorithm>
#include <string>

#include <simvis/simulation.h>
#include "program/report/scan_variant.h"
#include "sensors/laser_scanner/laser_scanner.h"
#include "tests/support/error_of.h"
#include "tests/support/parts/stub_part.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("sensors");

namespace simvis::test {
namespace {

// Attributes start in line 2, column 3.
std::string scanner(const std::string& attributes) {
  return "<sensor type='laser_scanner' name='SCAN' insert_at='ROOT'\n  " + attributes + "/>";
}

Simulation load(const std::string& attributes, std::vector<AttributeOverride> overrides = {}) {
  SimulationDesc desc;
  desc.overrides = std::move(overrides);
  return Simulation::from_string(scanner(attributes), desc, ".", "s.xml");
}

std::string method_of(const std::string& attributes, std::vector<AttributeOverride> overrides = {}) {
  return load(attributes, std::move(overrides)).sensors().at(0).method;
}

std::string refusal(const std::string& attributes, std::vector<AttributeOverride> overrides = {}) {
  return error_of([&] { load(attributes, std::move(overrides)); });
}

Command command_of(const std::string& attributes) { return parse_commands(scanner(attributes), "s.xml", ".").at(0); }

constexpr const char* kTolerances[] = {"max_error_m", "max_error_rel"};

}  // namespace

TEST_CASE("each method has a name that is in the attribute table") {
  const SensorType* const type = find_sensor_type("laser_scanner");
  const auto row = std::ranges::find(type->attributes, "method", &AttributeSpec::name);
  std::string offered;
  for (const ScanMethod method :
       {ScanMethod::nearest, ScanMethod::planar, ScanMethod::hybrid, ScanMethod::raycast, ScanMethod::automatic}) {
    offered += (offered.empty() ? "" : " ") + std::string(to_string(method));
    CHECK(find_scan_method(to_string(method)) == method);
  }
  CHECK(row->choices == offered);
  CHECK(find_scan_method("sonar") == std::nullopt);
}

TEST_CASE("a scanner without a method casts rays; with a tolerance it is hybrid and casts where necessary") {
  CHECK(method_of("") == "raycast");
  CHECK(method_of("preset='sick_lms200'") == "raycast");
  CHECK(method_of("resolution='512'") == "raycast");
  for (const std::string tolerance : kTolerances) {
    CHECK(method_of(tolerance + "='0.01'") == "hybrid");
    CHECK(method_of(tolerance + "='0.01' preset='sick_lms200'") == "hybrid");
    for (const std::string method : {"hybrid", "auto"}) {
      CHECK(method_of("method='" + method + "' " + tolerance + "='0.01'") == method);
    }
  }
}

TEST_CASE("a tolerance that the method does not use is an error with its place") {
  for (const std::string method : {"nearest", "planar", "raycast"}) {
    for (const std::string tolerance : kTolerances) {
      CHECK(refusal("method='" + method + "' " + tolerance + "='0.01'") ==
            "s.xml:2:" + std::to_string(3 + method.size() + 10) + ": error: attribute \"" + tolerance +
                "\": method \"" + method +
                "\" ignores a tolerance, expected method hybrid or auto, or none, which is hybrid here");
    }
  }
}

TEST_CASE("an override is checked against the scene's tolerance unless it drops the tolerance") {
  const std::string written = "max_error_m='0.01'";
  const AttributeOverride planar{"laser_scanner", "method", "planar", "--method"};
  CHECK(refusal(written, {planar}).starts_with("s.xml:2:3: error: attribute \"max_error_m\": method \"planar\""));
  CHECK(method_of(written, {planar, {"laser_scanner", "max_error_m", {}, {}}}) == "planar");
  CHECK(method_of("method='planar'", {{"laser_scanner", "method", {}, {}}}) == "raycast");
  const AttributeOverride tolerance{"laser_scanner", "max_error_m", "0.01", "--max-error"};
  CHECK(method_of("", {tolerance}) == "hybrid");
  CHECK(refusal("method='planar'", {tolerance}).starts_with("--max-error: error: attribute \"max_error_m\": method"));
}

TEST_CASE("a scanner in a part follows the same rules, and its error names the part's file") {
  const TemporaryFolder folder;
  const auto part_with = [&](const std::string& attributes) {
    write_text(folder / "part.stub", "<sensor type='laser_scanner' name='SCAN' " + attributes + "/>\n");
    return Simulation::from_string(R"(<part file="part.stub" name="PART" insert_at="ROOT"/>)", {}, folder.path());
  };
  CHECK(part_with("").sensors().at(0).method == "raycast");
  CHECK(part_with("max_error_rel='1e-4'").sensors().at(0).method == "hybrid");
  const std::string error = error_of([&] { part_with("method='nearest' max_error_rel='1e-4'"); });
  CHECK(error.find("part.stub(command 1):1:") != std::string::npos);
  CHECK(error.find("attribute \"max_error_rel\": method \"nearest\" ignores a tolerance") != std::string::npos);
}

TEST_CASE("an effect that follows beams needs raycast or no method, and never a tolerance") {
  const std::string effect = "sweep='0.01' ";
  CHECK(method_of(effect) == "raycast");
  CHECK(method_of(effect + "method='raycast'") == "raycast");
  for (const std::string method : {"nearest", "planar", "hybrid", "auto"}) {
    const std::string error = refusal(effect + "method='" + method + "'");
    CHECK(error.starts_with("s.xml:2:16: error: attribute \"method\": \"" + method + "\" cannot show"));
    CHECK(error.ends_with("expected raycast, or none, which is raycast here"));
  }
  for (const std::string tolerance : kTolerances) {
    const std::string error = refusal(effect + tolerance + "='0.01'");
    CHECK(error.starts_with("s.xml:2:16: error: attribute \"" + tolerance + "\": a scanner that keeps a tolerance"));
    CHECK(error.ends_with("expected no tolerance"));
    CHECK(refusal(effect + "method='raycast' " + tolerance + "='0.01'").find("ignores a tolerance") !=
          std::string::npos);
  }
}

TEST_CASE("the price list contains the scene's methods with their tolerance") {
  CHECK(attributes_of(scan_variants(command_of("")).own) == R"(method="raycast")");
  CHECK(attributes_of(scan_variants(command_of("max_error_rel='0.001'")).own) ==
        R"(method="hybrid" resolution="4096" max_error_rel="0.001")");
  CHECK(attributes_of(scan_variants(command_of("max_error_m='0.01'")).own) ==
        R"(method="hybrid" resolution="4096" max_error_m="0.01")");
  CHECK(attributes_of(scan_variants(command_of("method='auto' max_error_m='0.01'")).own) ==
        R"(method="auto" max_error_m="0.01")");
  // Methods that cannot measure with the effect have no price.
  CHECK(scan_variants(command_of("sweep='0.01'")).priced.size() == 1);
  for (const char* attributes : {"", "max_error_m='0.01'", "method='auto' max_error_m='0.01'", "sweep='0.01'"}) {
    CAPTURE(attributes);
    Simulation simulation = load(attributes);
    const Command command = simulation.diagnostics().command("SCAN");
    for (const ScanVariant& variant : scan_variants(command).priced) {
      CHECK_NOTHROW(simulation.add_variant("SCAN", with_variant(command, variant, "OTHER" + attributes_of(variant))));
    }
  }
}

}  // namespace simvis::test

TEST_SUITE_END();
