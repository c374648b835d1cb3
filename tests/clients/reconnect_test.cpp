// A host that is restarted: its clients notice, and the same connection finds the next one.
#include <doctest/doctest.h>

#include <optional>

#include "tests/clients/python_client.h"
#include "tests/clients/shared_host.h"
#include "tests/support/run_process.h"
#include "tests/support/skip.h"

using namespace simvis;
using client::Connection;

TEST_SUITE_BEGIN("clients");

TEST_CASE("reconnect: the same connection reads and writes the next host, and stays as it was while there is none") {
  const std::string name = unique_name("reconnect");
  std::optional<SharedHost> host(std::in_place, name);
  host->publish();
  add_pose(*host, "FIRST");
  Connection connection(name, "driver");
  const std::uint64_t generation = simvis_generation(connection.get());
  host.reset();
  CHECK_FALSE(connection.alive());
  CHECK_THROWS(connection.reconnect(0));
  CHECK(simvis_is_missing() == 1);
  CHECK(connection.element("FIRST") == 0);  // as it stood
  host.emplace(name).publish();
  add_pose(*host, "OTHER");
  add_pose(*host, "FIRST");
  connection.reconnect(5000);
  CHECK(connection.alive());
  CHECK(simvis_generation(connection.get()) != generation);
  CHECK(connection.element("FIRST") == 1);
  connection.set(connection.parameter("FIRST", "x"), 3);
  connection.send("<request/>");
  const ClientInputs inputs = host->take();
  REQUIRE(inputs.values.size() == 1);
  CHECK(inputs.values[0].parameter == kPoseValues);
  CHECK(inputs.requests.size() == 1);
  CHECK(host->is_connected("driver"));
}

TEST_CASE("reconnect in Python") {
  if (Process({"/usr/bin/python3", "-c", "import numpy"}).wait().exit_code != 0) {
    return test::skip("there is no NumPy for /usr/bin/python3");
  }
  const std::string name = unique_name("reconnect-python");
  std::optional<SharedHost> host(std::in_place, name);
  host->publish();
  add_pose(*host, "FIRST");
  const std::string script = R"(
import simvis_client
with simvis_client.connect(")" +
                             name + R"(", client="python", timeout_s=60) as sim:
    assert sim.elements() == ["FIRST"]
    print("connected", flush=True)
    while sim.wait_frame(timeout_s=60):
        pass
    assert not sim.alive()
    sim.reconnect(timeout_s=60)
    while "SECOND" not in sim:  # the test adds it when the host is there
        assert sim.alive()
    assert sim.elements() == ["SECOND"]
    sim["SECOND"]["x"] = 2
)";
  Process client({"/usr/bin/python3", "-c", script}, python_client_environment());
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  while (!host->is_connected("python") && std::chrono::steady_clock::now() < end) ::usleep(1000);
  host.reset();
  host.emplace(name).publish();
  add_pose(*host, "SECOND");
  const ProcessResult result = client.wait();
  CHECK_MESSAGE(result.exit_code == 0, result.err);
  CHECK(host->take().values.size() == 1);
}

TEST_CASE("errors that waiting does not mend are raised at once in Python, and close() may be called twice") {
  if (Process({"/usr/bin/python3", "-c", "import numpy"}).wait().exit_code != 0) {
    return test::skip("there is no NumPy for /usr/bin/python3");
  }
  const std::string name = unique_name("permanent");
  SharedHost host(name);
  host.publish();
  const std::string script = R"(
import simvis_client
for served, client in ((")" + name +
                             R"(", "no name"), ("../x", "python")):
    try:
        simvis_client.connect(served, client=client, timeout_s=1e6)
    except simvis_client.MissingHost:
        raise
    except simvis_client.SimvisError as error:
        assert "expected 1 to 63" in str(error), error
try:
    simvis_client.connect("nobody-serves-this", timeout_s=0.1)
    raise AssertionError("connected")
except simvis_client.MissingHost as error:
    assert "no simulation is served" in str(error), error
with simvis_client.connect(")" +
                             name + R"(") as sim:
    sim.close()
    assert not sim.alive()
    sim.close()
)";
  Process client({"/usr/bin/timeout", "60", "/usr/bin/python3", "-c", script}, python_client_environment());
  const ProcessResult result = client.wait();
  CHECK_MESSAGE(result.exit_code == 0, result.err);
}

TEST_SUITE_END();
