// Hosts of other users, names that other processes have taken, and memory that another process could make shorter.
#include <doctest/doctest.h>
#include <fcntl.h>
#include <grp.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/wait.h>

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <simvis/error.h>
#include "tests/clients/python_client.h"
#include "tests/clients/shared_host.h"
#include "tests/support/error_of.h"
#include "tests/support/run_process.h"
#include "tests/support/skip.h"
#include "tests/support/tested_build.h"

using namespace simvis;
using client::Connection;

TEST_SUITE_BEGIN("clients");

namespace {

struct User {
  uid_t user;
  gid_t group;
};
constexpr User kRoot{0, 0}, kHost{65534, 65534}, kMember{65533, 65534}, kStranger{65533, 65533};

void become(User user) {
  const bool became = ::setgroups(0, nullptr) == 0 && ::setresgid(user.group, user.group, user.group) == 0 &&
                      ::setresuid(user.user, user.user, user.user) == 0 &&
                      ::prctl(PR_SET_DUMPABLE, 1) == 0;  // as after the start of a program
  if (!became) ::_exit(1);
}

/// A process that does `work`, writes the text that this returns, and lives on until it is killed.
class OtherProcess {
 public:
  explicit OtherProcess(const std::function<std::string()>& work) {
    int ends[2];
    REQUIRE(::pipe2(ends, O_CLOEXEC) == 0);
    child_ = ::fork();
    if (child_ == 0) {
      std::string text;
      try {
        text = work();
      } catch (const std::exception& error) {
        text = error.what();
      }
      if (::write(ends[1], text.data(), text.size()) < 0) ::_exit(1);
      ::close(ends[1]);
      for (;;) ::pause();
    }
    ::close(ends[1]);
    char bytes[512];
    for (ssize_t size; (size = ::read(ends[0], bytes, sizeof bytes)) > 0;) {
      text_.append(bytes, static_cast<std::size_t>(size));
    }
    ::close(ends[0]);
  }
  ~OtherProcess() {
    ::kill(child_, SIGKILL);
    ::waitpid(child_, nullptr, 0);
  }
  OtherProcess(const OtherProcess&) = delete;
  OtherProcess& operator=(const OtherProcess&) = delete;

  const std::string& text() const { return text_; }

 private:
  pid_t child_;
  std::string text_;
};

/// A host in a process of this user; text(): "ready", or why there is none.
std::function<std::string()> host_of(User user, const std::string& name, SharedAccess access) {
  return [=] {
    become(user);
    auto* const host = new SharedHost(name, access);  // until the process is killed
    add_pose(*host, "P");
    host->publish();
    return std::string("ready");
  };
}

/// What the C client says to this user.
std::string connected_as(User user, const std::string& name) {
  const OtherProcess client([&] {
    become(user);
    const Connection connection(name, "client");
    return std::string("connected");
  });
  return client.text();
}

/// Listens under the name as a host does, and gives the first client `object`.
class FalseHost {
 public:
  explicit FalseHost(const std::string& name, int object = -1) : socket_(::socket(AF_UNIX, SOCK_STREAM, 0)) {
    const HostAddress address(name);
    REQUIRE(::bind(socket_, address.get(), address.size) == 0);
    REQUIRE(::listen(socket_, 1) == 0);
    if (object >= 0) answer_ = std::thread([this, object] { answer(object); });
  }
  ~FalseHost() {
    if (answer_.joinable()) answer_.join();
    ::close(socket_);
  }
  FalseHost(const FalseHost&) = delete;
  FalseHost& operator=(const FalseHost&) = delete;

 private:
  void answer(int object) const {
    const int connection = ::accept(socket_, nullptr, nullptr);
    char content = 0;
    iovec part{&content, 1};
    alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof object)> control{};
    msghdr message{};
    message.msg_iov = &part;
    message.msg_iovlen = 1;
    message.msg_control = control.data();
    message.msg_controllen = control.size();
    cmsghdr* const head = CMSG_FIRSTHDR(&message);
    *head = {.cmsg_len = CMSG_LEN(sizeof object), .cmsg_level = SOL_SOCKET, .cmsg_type = SCM_RIGHTS};
    std::memcpy(CMSG_DATA(head), &object, sizeof object);
    ::sendmsg(connection, &message, MSG_NOSIGNAL);
    ::close(connection);
  }

  int socket_;
  std::thread answer_;
};

bool is_root() {
  if (::geteuid() == 0) return true;
  test::skip("only root can act as two users");
  return false;
}

}  // namespace

TEST_CASE("clients accept hosts of their own user, and in a group those that are served to it; root only its own") {
  if (!is_root()) return;
  const std::string name = unique_name("users");
  struct Case {
    User host;
    SharedAccess access;
    User client;
    const char* says;
  };
  constexpr const char *kConnected = "connected", *kOtherUser = "of another user", *kNotServed = "to another user or",
                       *kNotOfRoot = "another user (65534), expected one of root",
                       *kGroupOfRoot = "is served to a group, expected for root one that root alone can write";
  constexpr auto kUser = SharedAccess::user, kGroup = SharedAccess::group;
  const Case cases[] = {{kHost, kUser, kHost, kConnected},       {kHost, kUser, kMember, kNotServed},
                        {kHost, kUser, kStranger, kOtherUser},   {kHost, kUser, kRoot, kNotOfRoot},
                        {kHost, kGroup, kHost, kConnected},      {kHost, kGroup, kMember, kConnected},
                        {kHost, kGroup, kStranger, kOtherUser},  {kHost, kGroup, kRoot, kNotOfRoot},
                        {kRoot, kUser, kRoot, kConnected},       {kRoot, kUser, kHost, kOtherUser},
                        {kRoot, kGroup, kRoot, kGroupOfRoot},    {kRoot, kGroup, kHost, kOtherUser},
                        {kRoot, kGroup, {65534, 0}, kConnected}, {kRoot, kUser, {65534, 0}, kNotServed},
                        {{65534, 0}, kGroup, kRoot, kNotOfRoot}};
  for (const Case& each : cases) {
    CAPTURE(each.host.user);
    CAPTURE(static_cast<int>(each.access));
    CAPTURE(each.client.user);
    CAPTURE(each.client.group);
    const OtherProcess host(host_of(each.host, name, each.access));
    REQUIRE(host.text() == "ready");
    CHECK(contains(connected_as(each.client, name), each.says));
  }
}

TEST_CASE("every client of root refuses a host of another user, at once") {
  if (!is_root()) return;
  const std::string name = unique_name("stranger");
  const OtherProcess host(host_of(kHost, name, SharedAccess::group));
  REQUIRE(host.text() == "ready");
  const std::string refused = "of another user (65534), expected one of root";
  const auto check = [&](const std::vector<std::string>& command) {
    CAPTURE(command[0]);
    const ProcessResult result = Process(command, python_client_environment()).wait();
    CHECK(result.exit_code == 1);
    CHECK(contains(result.err, refused));
  };
  const std::string bin = tested_build() + "/bin/";
  check({bin + "simvis-ctl", name, "list"});
  check({bin + "simvis-run", "--follow", name, "--frames", "1"});
  if (Process({"/usr/bin/python3", "-c", "import numpy"}).wait().exit_code != 0) {
    return test::skip("there is no NumPy for /usr/bin/python3");
  }
  check({"/usr/bin/python3", "-c", "import sys, simvis_client; simvis_client.connect(sys.argv[1], timeout_s=5)", name});
}

TEST_CASE("a name that another user has taken is an error of the next host, which says so") {
  if (!is_root()) return;
  const std::string name = unique_name("taken");
  const OtherProcess squatter([&] {
    become(kStranger);
    new FalseHost(name);
    return std::string("ready");
  });
  REQUIRE(squatter.text() == "ready");
  const std::string error = error_of([&] { SharedHost(name).publish(); });
  CHECK(contains(error, "of another user (65533) has the name \"" + name + "\", expected another name"));
}

TEST_CASE("no process can make the memory of a host shorter") {
  const std::string name = unique_name("truncated");
  SharedHost host(name, ::geteuid() == 0 ? SharedAccess::user : SharedAccess::group);
  host.publish();
  add_pose(host, "P");
  const std::size_t sensor = host.add_sensor("S", "laser_scanner");
  const Connection connection(name, "reader");
  const int object = open_object(name);
  CHECK(::ftruncate(object, 0) == -1);
  CHECK(::ftruncate(object, off_t{1} << 40) == -1);
  CHECK(::fcntl(object, F_ADD_SEALS, F_SEAL_FUTURE_WRITE) == -1);  // it would keep later clients out
  ::close(object);
  publish_scan(host, sensor, 0, 2.5f);
  host.finish_frame(1, 0);
  const auto scan = connection.latest(connection.sensor("S"));
  REQUIRE(scan);
  CHECK(scan->output<float>("range_m")[0] == 2.5f);
  CHECK_NOTHROW(Connection(name, "later"));
}

// The same bytes as those of a living host, locks included, in a file that its owner can make shorter while it is read.
TEST_CASE("a client refuses memory that can become shorter") {
  const std::string name = unique_name("shrinking");
  const SharedHost host(name + "-model");
  const_cast<SharedHost&>(host).publish();
  const int model = open_object(name + "-model"), copy = ::memfd_create("copy", MFD_CLOEXEC | MFD_ALLOW_SEALING);
  simvis_header header{};
  REQUIRE(::pread(model, &header, sizeof header, 0) == sizeof header);
  REQUIRE(::ftruncate(copy, static_cast<off_t>(header.total_size)) == 0);
  REQUIRE(::fchmod(copy, 0600) == 0);
  REQUIRE(::pwrite(copy, &header, sizeof header, 0) == sizeof header);
  struct flock lock {};
  lock.l_type = F_WRLCK;
  lock.l_whence = SEEK_SET;
  lock.l_start = SIMVIS_SHM_LOCK_BYTE;
  lock.l_len = 1;
  REQUIRE(::fcntl(copy, F_OFD_SETLK, &lock) == 0);
  for (const int seals : {0, F_SEAL_GROW, F_SEAL_SHRINK}) {
    CAPTURE(seals);
    REQUIRE(::fcntl(copy, F_ADD_SEALS, seals) == 0);
    const int given = ::open(("/proc/self/fd/" + std::to_string(copy)).c_str(), O_RDWR | O_CLOEXEC);
    const FalseHost false_host(name, given);
    simvis_client* const client = simvis_connect(name.c_str(), "reader", 0);
    CHECK((client != nullptr) == (seals == F_SEAL_SHRINK));
    if (client == nullptr) CHECK(simvis_client_error() == "\"" + name + "\" is no simulation");
    simvis_disconnect(client);
    ::close(given);
  }
  ::close(model);
  ::close(copy);
}

TEST_CASE("a process that was forked from the host's does not keep the name") {
  const std::string name = unique_name("forked");
  std::optional<SharedHost> host(std::in_place, name);
  host->publish();
  const OtherProcess child([] { return std::string(); });
  CHECK(is_served(name));
  host.reset();
  CHECK_FALSE(is_served(name));
  CHECK_NOTHROW(SharedHost(name).publish());
}

TEST_CASE("completion in bash executes nothing of the names that other processes chose") {
  const TemporaryFolder folder;
  const std::string name = unique_name("completed"), file = (folder / "executed").string();
  const FalseHost plain(name), hostile(name + "$(touch " + file + ")");
  const auto complete = [&](const std::string& words) {
    const ProcessResult result = Process({"bash", "-c",
                                          "compopt() { :; }\n"
                                          "simvis-ctl() { echo '  A$(touch " +
                                              file +
                                              ").x = 1'; echo '  B.y = 2'; }\n"
                                              "source " SIMVIS_SOURCE_DIR "/exchange/clients/simvis-ctl.bash\n"
                                              "COMP_WORDS=(simvis-ctl " +
                                              words +
                                              "); COMP_CWORD=$((${#COMP_WORDS[@]} - 1))\n"
                                              "_simvis_ctl; printf '%s\\n' \"${COMPREPLY[@]}\""})
                                     .wait();
    CHECK(result.err == "");
    CHECK_FALSE(std::filesystem::exists(file));
    return result.out;
  };
  CHECK(complete(name) == name + "\n");
  CHECK(complete(name + " s") == "set\nsend\n");
  CHECK(complete(name + " get B") == "B.y\n");
  CHECK(complete(name + " set ''") == "A\\$\\(touch\\ " + file + "\\).x=\nB.y=\n");
}

TEST_SUITE_END();
