// A plug-in that is wrong is an error with its file's name, and the program goes on.
#include <doctest/doctest.h>

#include <filesystem>
#include <string>

#include <simvis/element.h>
#include <simvis/error.h>
#include <simvis/plugin.h>
#include <simvis/simulation.h>
#include "tests/support/error_of.h"
#include "tests/support/tested_build.h"

TEST_SUITE_BEGIN("public");

namespace simvis {
namespace {

std::filesystem::path library(const std::string& name) {
  return tested_build() + "/lib/libsimvis_plugin_" + name + ".so";
}

// What is said of a plug-in that is refused; empty if it is not.
std::string refusal(const std::string& name) {
  const std::filesystem::path file = library(name);
  REQUIRE(std::filesystem::exists(file));
  const std::string message = error_of([&] { load_plugin(file); });
  CAPTURE(message);
  CHECK(message.starts_with(file.string() + ": error: "));
  return message;
}

bool says(const std::string& message, std::string_view part) { return message.find(part) != std::string::npos; }

}  // namespace

TEST_CASE("a plug-in with a type that exists is refused whole, each time") {
  for (int attempt = 0; attempt < 2; ++attempt) {
    const std::string message = refusal("duplicate_type");
    CHECK(says(message, "element type \"pose\": a type with this name already exists"));
    CHECK(find_element_type("own_type") == nullptr);
    CHECK(find_element_type("pose") != nullptr);
  }
}

TEST_CASE("a plug-in with a mistake in a table is refused") {
  const std::string message = refusal("bad_table");
  CHECK(says(message, "bad_table"));
  CHECK(says(message, "size"));
  CHECK(find_element_type("bad_table") == nullptr);
}

TEST_CASE("a plug-in that was built for another version is refused") {
  const std::string message = refusal("other_version");
  CHECK(says(message, "it was built for SimVis 0.0.9, and this is SimVis " + std::string(version())));
  CHECK(find_element_type("old_type") == nullptr);
}

TEST_CASE("a library that registers nothing is refused") { CHECK(says(refusal("no_types"), "registers no element")); }

TEST_CASE("a plug-in whose static initialiser throws or crashes is refused, each time") {
  for (int attempt = 0; attempt < 2; ++attempt) {
    CHECK(says(refusal("throwing_initialiser"), "a static initialiser throws: no file table.csv"));
    CHECK(says(refusal("crashing_initialiser"), "a program that tries it crashed (Aborted)"));
  }
}

TEST_CASE("after plug-ins were refused, scenes run as before") {
  refusal("duplicate_type");
  Simulation simulation = Simulation::from_string(R"(<element type="pose" name="POSE" insert_at="ROOT"/>)");
  simulation.set("POSE", "x", 1);
  simulation.step();
  CHECK(simulation.get("POSE", "x") == 1);
}

TEST_CASE("an element that cannot be made is an error at its command that names the library") {
  load_plugin(library("throwing_type"));
  load_plugin(library("throwing_type"));  // it is loaded already
  const auto message = [](const char* type) {
    return error_of([&] {
      Simulation::from_string("\n<element type=\"" + std::string(type) + "\" name=\"E\" insert_at=\"ROOT\"/>", {}, ".",
                              "scene.xml");
    });
  };
  const std::string thrown = message("throwing"), empty = message("empty");
  CAPTURE(thrown);
  CHECK(thrown.starts_with("scene.xml:2:2: error: "));
  CHECK(says(thrown, "libsimvis_plugin_throwing_type.so"));
  CHECK(says(thrown, "index 7 of 3"));
  CHECK(says(empty, "it returned nothing"));
}

}  // namespace simvis

TEST_SUITE_END();
