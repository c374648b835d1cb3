// The scene language: valid input and the place of each error.
#include <simvis/command.h>

#include <doctest/doctest.h>

#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("scenegraph");

namespace simvis {
namespace {

std::vector<Command> parse(std::string_view xml) { return parse_commands(xml, "s.xml", "folder"); }
std::string command_error(std::string_view xml) {
  return error_of([&] { parse(xml); });
}

TEST_CASE("commands are read with and without a root element") {
  const std::string_view bare = "<part file=\"a.glb\" name=\"A\"/><element type='pose' name='P'/><sensor/>";
  for (const std::string& xml : {std::string(bare), "<scene>" + std::string(bare) + "</scene>",
                                 "<?xml version=\"1.0\"?><!-- c --><any><!-- d -->" + std::string(bare) + "</any>"}) {
    CAPTURE(xml);
    const std::vector<Command> commands = parse(xml);
    REQUIRE(commands.size() == 3);
    CHECK(commands[0].kind == CommandKind::part);
    CHECK(commands[1].kind == CommandKind::element);
    CHECK(commands[2].kind == CommandKind::sensor);
    CHECK(commands[0].folder == "folder");
    REQUIRE(commands[0].find("name") != nullptr);
    CHECK(commands[0].find("name")->value == "A");
    CHECK(commands[0].find("up") == nullptr);
  }
}

TEST_CASE("a file without commands is an empty scene") {
  for (const char* xml : {"", "  \n", "<!-- nothing -->", "<scene/>", "<scene>\n</scene>", "\xef\xbb\xbf"}) {
    CAPTURE(xml);
    CHECK(parse(xml).empty());
  }
}

TEST_CASE("places count lines and bytes from 1 for all line endings") {
  for (const std::string end : {"\n", "\r\n", "\r"}) {
    for (const std::string start : {"", "\xef\xbb\xbf"}) {
      const std::string xml = start + "<scene>" + end + "  <part" + end + "    file = 'x > y=\"z\"'" + end +
                              "\tname=\"\xc3\xa4\" up=\"y\"/>" + end + "</scene>";
      const std::vector<Command> commands = parse(xml);
      REQUIRE(commands.size() == 1);
      CHECK(to_string(commands[0].where) == "s.xml:2:4");
      REQUIRE(commands[0].attributes.size() == 3);
      CHECK(to_string(commands[0].attributes[0].where) == "s.xml:3:5");
      CHECK(to_string(commands[0].attributes[1].where) == "s.xml:4:2");
      CHECK(to_string(commands[0].attributes[2].where) == "s.xml:4:12");
    }
  }
}

TEST_CASE("errors are reported at their place") {
  CHECK(command_error("<scene>\n <elemnt name='x'/></scene>") ==
        "s.xml:2:3: error: unknown command \"elemnt\", did you mean \"element\"? (expected part, element, sensor, "
        "remove, include, set, repeat or randomize)");
  CHECK(contains(command_error("<prat file='x'/>"),
                 "s.xml:1:2: error: unknown command \"prat\", did you mean \"part\"?"));
  CHECK(contains(command_error("<part name='a'\n up='y' name='b'/>"),
                 "s.xml:2:9: error: attribute \"name\" is given twice"));
  CHECK(
      contains(command_error("<scene>\n  hello <part/></scene>"), "s.xml:2:3: error: text \"hello\" between commands"));
  CHECK(contains(command_error("hello"), "s.xml:1:1: error: text \"hello\" between commands"));
  CHECK(contains(command_error("<part/>\n<![CDATA[x]]>"), "text \"x\" between commands"));
  CHECK(contains(command_error("<part>\n <part/></part>"),
                 "s.xml:2:3: error: a command has no content, expected <part .../>"));
  CHECK(
      contains(command_error("<scene version='1'><part/></scene>"), "s.xml:1:8: error: unknown attribute \"version\""));
  CHECK(contains(command_error("<part/><scene><part/></scene>"), "unknown command \"scene\""));
}

TEST_CASE("malformed XML and input that is not text") {
  CHECK(contains(command_error("<scene>\n<part file=\"a></scene>"), "malformed XML: "));
  CHECK(contains(command_error("<scene>\n<part></scene>"), "s.xml:2:"));
  CHECK(contains(command_error("<scene>\n<part></scene>"),
                 "malformed XML: tag <part> of line 2 is not closed, expected \"/>\""));
  CHECK(contains(command_error("<!-- <b> --><scene>\n<part name='>'/>"), "tag <scene> of line 1 is not closed"));
  CHECK(contains(command_error("<scene><?x <b>?><part/>\n<element a='/'></scene>"),
                 "tag <element> of line 2 is not closed"));
  CHECK(contains(command_error("<part/></scene>"), "malformed XML: tag </scene> closes nothing"));
  CHECK(contains(command_error("<part a=1/>"), "s.xml:1:9: error: malformed XML: "));
  CHECK(contains(command_error(std::string_view("\xff\xfe<\0p\0", 6)),
                 "s.xml:1:1: error: byte 0xff is not allowed in UTF-8"));
  CHECK(contains(command_error(std::string_view("<part/>\n\0", 9)),
                 "s.xml:2:1: error: byte 0x00 is not allowed in UTF-8"));
  CHECK(contains(command_error("<part name='\xc0\xaf'/>"), "s.xml:1:13: error: byte 0xc0"));
  CHECK(contains(command_error("<part name='\xed\xa0\x80'/>"), "byte 0xed"));
  CHECK(contains(command_error("<part name='\xe2\x82'/>"), "byte 0xe2"));
}

TEST_CASE("deep nesting is an error, not a crash") {
  constexpr int kDepth = 200000;
  std::string xml;
  for (int i = 0; i < kDepth; ++i) xml += "<a>";
  for (int i = 0; i < kDepth; ++i) xml += "</a>";
  CHECK(contains(command_error(xml), "s.xml:1:5: error: unknown command \"a\""));
}

TEST_CASE("names") {
  CHECK(contains(command_error("<part name=''/>"),
                 "s.xml:1:7: error: attribute \"name\": \"\" is not allowed, expected a name"));
  CHECK(contains(command_error("<element name='  '/>"), "expected a name that is not empty"));
  CHECK(contains(command_error("<sensor name='a/b'/>"), "expected a name without '.' and '/'"));
  CHECK(contains(command_error("<sdf version='1.6'><world name='w'/></sdf>"),
                 "this is a world or model in SDF, expected a scene"));
  CHECK(contains(command_error("<sensor name='a.b'/>"), "expected a name without '.' and '/'"));
  CHECK(parse("<element name='a.b/c'/>").size() == 1);
  CHECK(
      contains(command_error("<part name='a&#10;b'/>"), "\"a\\x0ab\" is not allowed, expected a name without control"));
  CHECK(parse("<part name='chair.001/visual'/>").size() == 1);
}

TEST_CASE("a command is printed in the scene language and reads back") {
  const std::vector<Command> commands = parse("<part file='a \"&lt;&amp;>&#10;b' up='y'/>");
  const std::string text = to_string(commands[0]);
  CHECK(text == "<part file=\"a &quot;&lt;&amp;>&#10;b\" up=\"y\"/>");
}

TEST_CASE("files") {
  const TemporaryFolder folder;
  CHECK(contains(error_of([&] { read_commands(folder / "none.xml"); }),
                 "none.xml: error: cannot be read: No such file or directory"));
  CHECK(contains(error_of([&] { read_commands(folder.path()); }), "cannot be read: it is a folder"));
  write_text(folder / "a.xml", "<part/>\n<prt/>");
  CHECK(contains(error_of([&] { read_commands(folder / "a.xml"); }), "a.xml:2:2: error: unknown command \"prt\""));
  write_text(folder / "a.xml", "<part/>");
  CHECK(read_commands(folder / "a.xml").at(0).folder == folder.path());
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
