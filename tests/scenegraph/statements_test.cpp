// The statements set, repeat and include: which commands they make, and what is refused.
#include <simvis/command.h>

#include <doctest/doctest.h>

#include <string>

#include "tests/support/error_of.h"
#include "tests/support/random_numbers.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("scenegraph");

namespace simvis {
namespace {

std::string texts(const std::vector<Command>& commands) {
  std::string text;
  for (const Command& command : commands) text += to_string(command) + "\n";
  return text;
}

std::string made(std::string_view xml) { return texts(parse_commands(xml, "s.xml", "folder")); }
std::string refused(std::string_view xml) {
  return error_of([&] { parse_commands(xml, "s.xml", "folder"); });
}

// Files in a folder, and their messages without the folder's name.
struct Files {
  Files(std::initializer_list<std::pair<const char*, const char*>> files) {
    for (const auto& [name, text] : files) {
      std::filesystem::create_directories((folder / name).parent_path());
      write_text(folder / name, text);
    }
  }
  std::vector<Command> read() const { return read_commands(folder / "s.xml"); }
  std::string error() const {
    std::string message = error_of([&] { read(); });
    const std::string root = std::filesystem::canonical(folder.path()).string() + "/";
    for (std::size_t at; (at = message.find(root)) != std::string::npos;) message.erase(at, root.size());
    return message;
  }
  TemporaryFolder folder;
};

TEST_CASE("a scene with set and repeat is the scene written out") {
  CHECK(made(R"(<simvis>
      <set name="gap" value="0.5"/>
      <set name="step" value="${gap * 3}"/>
      <repeat count="2" as="row">
        <set name="y" value="${row * step}"/>
        <repeat count="${row + 1}" as="i">
          <part name="P_${row}_${i}" insert_at="ROOT" pose_offset="${i * gap} ${y} 0 0 0 ${90 * i}"/>
        </repeat>
      </repeat>
      <sensor name="S" x="${step}"/>
    </simvis>)") == made(R"(
      <part name="P_0_0" insert_at="ROOT" pose_offset="0 0 0 0 0 0"/>
      <part name="P_1_0" insert_at="ROOT" pose_offset="0 1.5 0 0 0 0"/>
      <part name="P_1_1" insert_at="ROOT" pose_offset="0.5 1.5 0 0 0 90"/>
      <sensor name="S" x="1.5"/>)"));
  CHECK(made("<repeat count='0' as='i'><part name='P'/></repeat>").empty());
}

TEST_CASE("variables end with their block") {
  CHECK(contains(refused("<repeat count='1' as='i'><set name='x' value='1'/></repeat><part name='${x}'/>"),
                 "there is no variable \"x\""));
  CHECK(contains(refused("<repeat count='1' as='i'/><part name='${i}'/>"), "there is no variable \"i\""));
  CHECK(contains(refused("<part name='${x}'/><set name='x' value='1'/>"), "there is no variable \"x\""));
}

TEST_CASE("mistakes in set and repeat are reported where they stand") {
  CHECK(refused("<part name='a'\n up='${1 / 0}'/>") ==
        "s.xml:2:2: error: attribute \"up\": \"${1 / 0}\": division by zero");
  CHECK(contains(refused("<set name='a' value='1'/><set name='a' value='2'/>"),
                 "s.xml:1:31: error: the variable \"a\" has a value already"));
  CHECK(contains(refused("<set name='a' value='1'/><repeat count='1' as='a'/>"), "has a value already"));
  CHECK(contains(refused("<set name='pi' value='1'/>"), "s.xml:1:6: error: attribute \"name\": \"pi\" is not allowed"));
  CHECK(contains(refused("<set name='a' value='1 2'/>"), "expected a finite number or ${EXPRESSION}"));
  CHECK(contains(refused("<set name='a'/>"), "s.xml:1:2: error: set without attribute \"value\", expected one"));
  CHECK(contains(refused("<set value='1'/>"), "set without attribute \"name\""));
  CHECK(contains(refused("<set name='a' valu='1'/>"), "did you mean \"value\"?"));
  CHECK(contains(refused("<set name='a' value='1'><part/></set>"), "a command has no content, expected <set .../>"));
  CHECK(contains(refused("<repeat count='2'/>"), "repeat without attribute \"as\""));
  CHECK(contains(refused("<repeat as='i'/>"), "repeat without attribute \"count\""));
  for (const char* count : {"-1", "1.5", "x", "100001", ""}) {
    CAPTURE(count);
    CHECK(contains(refused("<repeat as='i' count='" + std::string(count) + "'/>"),
                   "is not allowed, expected a whole number from 0 to 100000"));
  }
  CHECK(contains(refused("<repeat count='1' as='i'>text</repeat>"), "text \"text\" between commands"));
  CHECK(contains(refused("<repaet count='1' as='i'/>"), "did you mean \"repeat\"?"));
}

TEST_CASE("a short text cannot make a scene without end") {
  const std::string many = "<repeat count='100000' as='i'><repeat count='100000' as='k'>";
  const std::string message = "repetitions and included files make more than 200000 commands";
  CHECK(contains(refused(many + "</repeat></repeat>"), message));
  CHECK(contains(refused(many + "<part name='a'/></repeat></repeat>"), message));
  CHECK(
      contains(refused("<repeat count='100000' as='i'><part x='" + std::string(3000, 'x') + "'/></repeat>"), message));
  std::string deep, ends;
  for (int i = 0; i < 100; ++i) {
    deep += "<repeat count='1' as='i" + std::to_string(i) + "'>";
    ends += "</repeat>";
  }
  CHECK(contains(refused(deep + ends), "repetitions are nested deeper than 64"));
}

TEST_CASE("an included file stands for its commands, relative to its own folder") {
  const Files files{
      {"s.xml", "<set name='x' value='1'/><include file='sub/a.xml'/><part name='B' file='b.glb'/>"},
      {"sub/a.xml", "<scene><set name='x' value='2'/><include file='c.xml'/><part name='A${x}'/></scene>"},
      {"sub/c.xml", "<part name='C'/>"}};
  const std::vector<Command> commands = files.read();
  CHECK(texts(commands) == "<part name=\"C\"/>\n<part name=\"A2\"/>\n<part name=\"B\" file=\"b.glb\"/>\n");
  CHECK(commands[0].folder.filename() == "sub");
  CHECK(commands[2].folder == files.folder.path());
  CHECK(commands[2].scope == nullptr);
}

TEST_CASE("a mistake in an included file names its place, and the places that include it") {
  CHECK(Files{{"s.xml", "\n<include file='a.xml'/>"}, {"a.xml", "<part name='A'/>\n <prat/>"}}.error().starts_with(
      "a.xml:2:3: error: unknown command \"prat\", did you mean \"part\"?"));
  CHECK(Files{{"s.xml", "\n<include file='a.xml'/>"}, {"a.xml", "<part name='A'/>\n <prat/>"}}.error().ends_with(
      " (included from s.xml:2:2)"));
  CHECK(Files{{"s.xml", "<include file='a.xml'/>"}, {"a.xml", "\n <include file='b.xml'/>"}, {"b.xml", "<part"}}
            .error()
            .ends_with(" (included from a.xml:2:3, included from s.xml:1:2)"));
  CHECK(contains(
      Files{{"s.xml", "<set name='x' value='1'/><include file='a.xml'/>"}, {"a.xml", "<part name='${x}'/>"}}.error(),
      "a.xml:1:7: error: attribute \"name\": \"${x}\": there is no variable \"x\""));
}

TEST_CASE("mistakes in include") {
  CHECK(contains(Files{{"s.xml", "<include file='no.xml'/>"}}.error(), "s.xml:1:10: error: there is no file"));
  CHECK(contains(Files{{"s.xml", "<include file='.'/>"}}.error(), "is not a file, expected a scene file"));
  CHECK(contains(Files{{"s.xml", "<include/>"}}.error(), "include without attribute \"file\""));
  CHECK(contains(Files{{"s.xml", "<include file='a' prefx='A/'/>"}}.error(), "did you mean \"prefix\"?"));
  for (const char* prefix : {"", "  ", "/A", "A.", "A&#10;"}) {
    CAPTURE(prefix);
    const std::string xml = "<include file='a.xml' prefix='" + std::string(prefix) + "'/>";
    CHECK(contains(Files{{"s.xml", xml.c_str()}, {"a.xml", ""}}.error(), "s.xml:1:23: error: attribute \"prefix\""));
  }
}

TEST_CASE("files that include each other are an error that shows the chain") {
  CHECK(contains(Files{{"s.xml", "<include file='s.xml'/>"}}.error(), "\"s.xml\" includes itself: s.xml > s.xml"));
  CHECK(contains(Files{{"s.xml", "<include file='a.xml'/>"},
                       {"a.xml", "<include file='b.xml'/>"},
                       {"b.xml", "<include file='./s.xml'/>"}}
                     .error(),
                 "\"./s.xml\" includes itself: s.xml > a.xml > b.xml > s.xml"));
}

TEST_CASE("broken statements are refused, or read, but never crash") {
  const std::string whole = R"(<s><set name="a" value="${2*3}"/><repeat count="${a}" as="i"><part name="P${i/a}"/>
    <repeat count="2" as="k"><element x="${min(i,k)}"/></repeat></repeat><include file="x" prefix="A/"/></s>)";
  constexpr std::string_view kBytes = "<>/\"'${}()*+-.,0129aieks= \n&";
  test::Random random(3);
  int wrong = 0;
  constexpr int kTexts = 20000;
  for (int n = 0; n < kTexts; ++n) {
    std::string text = whole;
    for (std::uint64_t changes = 1 + random.below(4); changes > 0; --changes) {
      text[random.below(text.size())] = kBytes[random.below(kBytes.size())];
    }
    wrong += refused(text) != "nothing was thrown";
  }
  CHECK(wrong > kTexts / 2);  // there is no file x
}

}  // namespace
}  // namespace simvis
