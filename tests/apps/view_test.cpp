// taut view as a browser, and as an attacker, would talk to it.

#include <gtest/gtest.h>
#include <ifaddrs.h>

#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>

#include "program.h"
#include "raw_http.h"

namespace taut::test {
namespace {

using Json = nlohmann::json;

const char* secret = "the secret beside the folder";

// A running `taut view` on a page of two files.
class Viewer {
 public:
  Viewer(const WorkFolder& folder, const std::string& result, std::vector<std::string> options = {})
      : program_(start(folder, result, std::move(options))) {
    const auto out = folder / ".stdout";
    RunningProgram::wait_until([&] { return read_text(out).find("Ctrl-C") != std::string::npos; });
    const std::string text = read_text(out);
    const std::size_t at = text.find("http://127.0.0.1:");
    EXPECT_NE(at, std::string::npos) << text << read_text(folder / ".stderr");
    if (at == std::string::npos) return;
    port = std::stoi(text.substr(at + 17));
    const std::size_t slash = text.find('/', at + 17);
    base = text.substr(slash, text.find('\n', slash) - slash);
  }
  ~Viewer() {
    program_.send(SIGINT);
    EXPECT_EQ(program_.wait().exit_code, 0);
  }
  Reply get(const std::string& name) const {
    return send_raw(port, request_text(port, base + name));
  }
  Json json(const std::string& name) const {
    const Reply reply = get(name);
    EXPECT_EQ(reply.status, 200) << name << ": " << reply.body;
    return Json::parse(reply.body, nullptr, false);
  }
  std::string status() const { return json("api/state").value("status", ""); }

  int port = 0;
  std::string base;  // "/KEY/"

 private:
  static RunningProgram start(const WorkFolder& folder, const std::string& result,
                              std::vector<std::string> options) {
    std::filesystem::create_directories(folder / "page/assets");
    folder.file("page/index.html", "<!doctype html>the page");
    folder.file("page/assets/index.js", "let page;");
    ::setenv("TAUT_VIEWER", (folder / "page").c_str(), 1);
    std::vector<std::string> arguments{"view", result, "--no-open"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    return RunningProgram(folder, arguments);
  }
  RunningProgram program_;
};

void run_small(const WorkFolder& folder, const std::string& out) {
  folder.file("small.toml", small_scene());
  folder.file("secret.txt", secret);
  ASSERT_EQ(taut(folder, {"run", "small.toml", "--out", out, "--quiet", "--no-picture"}).exit_code,
            0);
}

// The numbers of a .npy file of version 1.0.
std::string npy_numbers(const std::filesystem::path& path) {
  const std::string bytes = read_text(path);
  return bytes.substr(10 + static_cast<unsigned char>(bytes[8]) +
                      256u * static_cast<unsigned char>(bytes[9]));
}

template <class T>
std::vector<T> numbers(const std::string& bytes) {
  std::vector<T> values(bytes.size() / sizeof(T));
  std::memcpy(values.data(), bytes.data(), values.size() * sizeof(T));
  return values;
}

TEST(View, ServesAFinishedRun) {
  const WorkFolder folder;
  run_small(folder, "r");
  const Viewer viewer(folder, "r");
  const Json state = viewer.json("api/state");
  EXPECT_EQ(state.at("status"), "finished");
  EXPECT_EQ(state.at("frames"), 7);

  const Json scene = viewer.json("api/scene");
  EXPECT_EQ(scene.at("title"), "Small");
  EXPECT_EQ(scene.at("nodes"), 72);
  EXPECT_EQ(scene.at("triangles"), 112);
  EXPECT_EQ(scene.at("springs"), 8 * 8 + 9 * 7);
  EXPECT_NEAR(scene.at("frame_s").get<double>(), 0.015, 1e-15);
  EXPECT_EQ(scene.at("frames_expected"), 7);
  EXPECT_EQ(scene.at("cloths").at(0).at("name"), "sheet");
  EXPECT_EQ(scene.at("solids").at(0).at("shape"), "sphere");
  EXPECT_EQ(scene.at("solids").at(0).at("radius"), 0.3);
  EXPECT_EQ(scene.at("solids").at(0).at("poses"), Json::parse("[[0,0,0,0,0,0,1]]"));
  EXPECT_EQ(scene.at("note"), "");

  std::string all;
  for (int f = 0; f <= 6; ++f)
    all += npy_numbers(folder / ("r/frames/00000" + std::to_string(f) + ".npy"));
  const std::size_t frame = 72 * 3 * 4;
  EXPECT_EQ(viewer.get("api/frames?first=0&count=7").body, all);
  EXPECT_EQ(viewer.get("api/frames?first=2&count=3").body, all.substr(2 * frame, 3 * frame));
  EXPECT_EQ(viewer.get("api/frames?first=5&count=100").body, all.substr(5 * frame));
  EXPECT_EQ(viewer.get("api/frames?first=7&count=1").status, 404);
  std::string contact;
  for (int f = 0; f <= 6; ++f)
    contact += npy_numbers(folder / ("r/frames/contact_00000" + std::to_string(f) + ".npy"));
  EXPECT_EQ(contact.size(), 7u * 72);
  EXPECT_EQ(scene.at("contact"), true);
  EXPECT_EQ(viewer.get("api/contact?first=0&count=7").body, contact);
  EXPECT_EQ(viewer.get("api/contact?first=3&count=2").body, contact.substr(3 * 72, 2 * 72));
  EXPECT_EQ(viewer.get("api/contact?first=7&count=1").status, 404);
  EXPECT_EQ(viewer.get("api/triangles").body, npy_numbers(folder / "r/frames/triangles.npy"));
  EXPECT_EQ(viewer.get("api/uv").body, npy_numbers(folder / "r/frames/uv.npy"));

  // The sheet has 9 x 8 nodes on 0.6 m x 0.6 m.
  const auto ends = numbers<std::int32_t>(viewer.get("api/springs").body);
  const auto lengths = numbers<float>(viewer.get("api/rest_lengths").body);
  ASSERT_EQ(lengths.size(), 127u);
  for (std::size_t s = 0; s < lengths.size(); ++s) {
    const int apart = std::abs(ends[2 * s] - ends[2 * s + 1]);
    ASSERT_TRUE(apart == 1 || apart == 9) << s;
    EXPECT_NEAR(lengths[s], apart == 1 ? 0.6 / 8 : 0.6 / 7, 1e-7);
  }
}

TEST(View, PosesOfAMovingSolidFollowItsFrames) {
  const WorkFolder folder;
  folder.file("small.toml", std::string(small_scene()) + "velocity = [0, 2, 0]\n");
  ASSERT_EQ(taut(folder, {"run", "small.toml", "--out", "r", "--quiet", "--no-picture"}).exit_code,
            0);
  const Viewer viewer(folder, "r");
  const Json scene = viewer.json("api/scene"), poses = scene.at("solids").at(0).at("poses");
  ASSERT_EQ(poses.size(), 7u);
  for (int f = 0; f <= 6; ++f)
    EXPECT_NEAR(poses.at(static_cast<std::size_t>(f)).at(1).get<double>(), 2 * 0.015 * f, 1e-7);
}

// A tetrahedron that flies by: its corners at each frame, those that no triangle uses left out.
TEST(View, SolidsThatAreMeshesAreServedFrameByFrame) {
  const WorkFolder folder;
  folder.file("tetra.obj",
              "v 3 0 0\nv 4 0 0\nv 3 1 0\nv 3 0 1\nv 9 9 9\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
  folder.file("small.toml", std::string(small_scene()) +
                                "[[solid]]\nname = \"flier\"\nshape = \"mesh\"\nmesh = "
                                "\"tetra.obj\"\nvelocity = [0, 2, 0]\n");
  const ProgramEnd run =
      taut(folder, {"run", "small.toml", "--out", "r", "--quiet", "--no-picture"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const Viewer viewer(folder, "r");
  EXPECT_EQ(viewer.json("api/scene").at("solids").at(1).at("shape"), "mesh");
  EXPECT_EQ(numbers<std::int32_t>(viewer.get("api/solid_triangles?solid=1").body),
            (std::vector<std::int32_t>{0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3}));
  const std::vector<float> points = numbers<float>(viewer.get("api/solid_points?solid=1").body);
  ASSERT_EQ(points.size(), 7u * 4 * 3);
  const double corners[4][3] = {{3, 0, 0}, {4, 0, 0}, {3, 1, 0}, {3, 0, 1}};
  for (std::size_t f = 0; f < 7; ++f)
    for (std::size_t v = 0; v < 4; ++v)
      for (std::size_t i = 0; i < 3; ++i)
        EXPECT_NEAR(points[(f * 4 + v) * 3 + i],
                    corners[v][i] + (i == 1 ? 2 * 0.015 * static_cast<double>(f) : 0.0), 1e-6)
            << f;
  EXPECT_EQ(viewer.get("api/solid_points?solid=0").status, 404);  // a sphere
  EXPECT_EQ(viewer.get("api/solid_points?solid=../1").status, 400);
}

TEST(View, SendsStatsFromAnyByteInWholeRows) {
  const WorkFolder folder;
  run_small(folder, "r");
  const std::string stats = read_text(folder / "r/stats.csv");
  const Viewer viewer(folder, "r");
  EXPECT_EQ(viewer.get("api/stats?from=0").body, stats);
  const std::size_t row = stats.find('\n', stats.size() / 2) + 1;
  const Reply rest = viewer.get("api/stats?from=" + std::to_string(row));
  EXPECT_EQ(rest.body, stats.substr(row));
  EXPECT_EQ(rest.headers.at("taut-stats"), viewer.json("api/state").at("stats").get<std::string>());
  const Reply nothing = viewer.get("api/stats?from=" + std::to_string(stats.size()));
  EXPECT_EQ(nothing.status, 200);
  EXPECT_EQ(nothing.body, "");
  std::ofstream(folder / "r/stats.csv", std::ios::app) << "19,0.1,half a r";
  EXPECT_EQ(viewer.get("api/stats?from=0").body, stats);
}

TEST(View, ServesThePageWithAStrictPolicy) {
  const WorkFolder folder;
  run_small(folder, "r");
  const Viewer viewer(folder, "r");
  const Reply page = viewer.get("");
  EXPECT_EQ(page.status, 200);
  EXPECT_EQ(page.body, "<!doctype html>the page");
  EXPECT_EQ(page.headers.at("content-type"), "text/html; charset=utf-8");
  EXPECT_TRUE(page.headers.at("content-security-policy")
                  .starts_with("default-src 'none'; script-src 'self';"));
  EXPECT_EQ(page.headers.at("x-content-type-options"), "nosniff");
  EXPECT_EQ(page.headers.count("access-control-allow-origin"), 0u);
  EXPECT_EQ(viewer.get("assets/index.js").headers.at("content-type"),
            "text/javascript; charset=utf-8");
  EXPECT_EQ(viewer.get("assets/other.js").status, 404);
  const Reply head = send_raw(viewer.port, request_text(viewer.port, viewer.base, "HEAD"));
  EXPECT_EQ(head.status, 200);
  EXPECT_EQ(head.body, "");
}

TEST(View, RefusesPathTricks) {
  const WorkFolder folder;
  run_small(folder, "r");
  const Viewer viewer(folder, "r");
  const std::string b = viewer.base, absolute = (folder / "secret.txt").string();
  for (const std::string& target : {std::string("/"),
                                    std::string("/etc/passwd"),
                                    absolute,
                                    b + "../secret.txt",
                                    b + "../../secret.txt",
                                    b + "assets/../../secret.txt",
                                    b + "%2e%2e/secret.txt",
                                    b + "..%2fsecret.txt",
                                    b + "%2e%2e%2fsecret.txt",
                                    b + "..%5csecret.txt",
                                    b + "..\\secret.txt",
                                    b + "/" + absolute,
                                    b.substr(0, b.size() - 1) + absolute,
                                    b + "api/../secret.txt",
                                    b + "api/..%2f..%2fsecret.txt",
                                    b + "api//secret.txt",
                                    b + "api/scene.toml",
                                    b + "api/frames/../../secret.txt",
                                    b + "summary.json",
                                    b + "r/scene.toml",
                                    "http://127.0.0.1" + absolute,
                                    "file://" + absolute,
                                    b + "assets/index.js%00.txt",
                                    b + "api/frames?first=../../secret.txt&count=1",
                                    b + "api/frames?first=-1&count=1",
                                    b + "api/frames?first=1e1&count=1",
                                    b + "api/frames?first=99999999999999999999&count=1",
                                    b + "api/frames?first=0&count=0",
                                    b + "api/frames?first=0",
                                    b + "api/stats?from=-5",
                                    b + "api/stats",
                                    b + std::string(20000, 'a'),
                                    std::string("/00000000000000000000000000000000/api/state")}) {
    const Reply reply = send_raw(viewer.port, request_text(viewer.port, target));
    EXPECT_TRUE(reply.status >= 400 && reply.status < 500)
        << target.substr(0, 100) << ": " << reply.status;
    EXPECT_EQ(reply.body.find(secret), std::string::npos) << target;
    EXPECT_EQ(reply.body.find("root:"), std::string::npos) << target;
  }
  for (const std::string& rubbish :
       {std::string("\r\n\r\n"), std::string("GET\r\n\r\n"), std::string("\0\0\0\0\r\n\r\n", 8),
        "GET " + b + " HTTP/9.9\r\n\r\n"})
    EXPECT_NE(send_raw(viewer.port, rubbish, 300).status, 200);
  EXPECT_EQ(viewer.status(), "finished");  // still there
}

TEST(View, RefusesOtherHostsAndMethods) {
  const WorkFolder folder;
  run_small(folder, "r");
  const Viewer viewer(folder, "r");
  const std::string port = std::to_string(viewer.port),
                    line = "GET " + viewer.base + "api/state HTTP/1.1\r\n",
                    end = "Connection: close\r\n\r\n";
  const auto with_hosts = [&](const std::string& hosts) {
    return send_raw(viewer.port, line + hosts + end).status;
  };
  EXPECT_EQ(with_hosts("Host: 127.0.0.1:" + port + "\r\n"), 200);
  EXPECT_EQ(with_hosts("Host: localhost:" + port + "\r\n"), 200);
  EXPECT_EQ(with_hosts(""), 403);
  EXPECT_EQ(with_hosts("Host: rebound.example:" + port + "\r\n"), 403);
  EXPECT_EQ(with_hosts("Host: 127.0.0.1\r\n"), 403);
  EXPECT_EQ(with_hosts("Host: 127.0.0.1:" + port + ".rebound.example\r\n"), 403);
  EXPECT_EQ(with_hosts("Host: 127.0.0.1:" + port + "\r\nHost: rebound.example\r\n"), 403);
  for (const char* method : {"POST", "PUT", "DELETE", "PATCH", "OPTIONS"})
    EXPECT_EQ(
        send_raw(viewer.port, request_text(viewer.port, viewer.base + "api/state", method)).status,
        405)
        << method;
}

TEST(View, FollowsNoLinkToAFolder) {
  const WorkFolder folder;
  run_small(folder, "r");
  const Viewer viewer(folder, "r");
  EXPECT_EQ(viewer.get("api/triangles").status, 200);
  std::filesystem::rename(folder / "r/frames", folder / "outside");
  std::filesystem::create_directory_symlink(folder / "outside", folder / "r/frames");
  for (const char* name : {"api/frames?first=0&count=1", "api/triangles", "api/scene", "api/state"})
    EXPECT_EQ(viewer.get(name).status, 500) << name;
  EXPECT_NE(viewer.get("api/triangles").body.find("symbolic link"), std::string::npos);
}

TEST(View, FollowsNoLinkToAFile) {
  const WorkFolder folder;
  run_small(folder, "r");
  const Viewer viewer(folder, "r");
  namespace fs = std::filesystem;
  fs::rename(folder / "r/frames/000006.npy", folder / "outside.npy");
  fs::create_symlink(folder / "outside.npy", folder / "r/frames/000006.npy");
  EXPECT_EQ(viewer.get("api/frames?first=6&count=1").status, 500);
  fs::remove(folder / "r/stats.csv");
  fs::create_symlink(folder / "secret.txt", folder / "r/stats.csv");
  const Reply stats = viewer.get("api/stats?from=0");
  EXPECT_EQ(stats.status, 500);
  EXPECT_EQ(stats.body.find(secret), std::string::npos);
}

TEST(View, SaysWhatIsDamagedAndGoesOn) {
  const WorkFolder folder;
  run_small(folder, "r");
  const Viewer viewer(folder, "r");
  const std::string frame = read_text(folder / "r/frames/000003.npy");
  folder.file("r/frames/000003.npy", frame.substr(0, frame.size() / 2));
  const Reply cut = viewer.get("api/frames?first=3&count=1");
  EXPECT_EQ(cut.status, 500);
  EXPECT_NE(cut.body.find("000003.npy"), std::string::npos);
  EXPECT_EQ(viewer.get("api/frames?first=4&count=1").status, 200);
  folder.file("r/scene.toml", "broken");
  const Json scene = viewer.json("api/scene");
  EXPECT_EQ(scene.at("nodes"), 72);
  EXPECT_NE(scene.at("note").get<std::string>().find("scene.toml"), std::string::npos);
}

TEST(View, ListensOnLoopbackOnly) {
  const WorkFolder folder;
  run_small(folder, "r");
  const Viewer viewer(folder, "r");
  ifaddrs* list = nullptr;
  ASSERT_EQ(::getifaddrs(&list), 0);
  for (const ifaddrs* each = list; each; each = each->ifa_next) {
    if (!each->ifa_addr || each->ifa_addr->sa_family != AF_INET) continue;
    char text[INET_ADDRSTRLEN];
    ::inet_ntop(AF_INET, &reinterpret_cast<const sockaddr_in*>(each->ifa_addr)->sin_addr, text,
                sizeof text);
    if (std::string(text) == "127.0.0.1") continue;
    EXPECT_LT(connect_to(text, viewer.port), 0) << text;
  }
  ::freeifaddrs(list);
  EXPECT_LT(connect_to("127.0.0.2", viewer.port), 0);
}

TEST(View, ChangesNothing) {
  const WorkFolder folder;
  run_small(folder, "r");
  const auto facts = [&] {
    std::string text;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder / "r"))
      text += entry.path().string() + (entry.is_regular_file() ? read_text(entry.path()) : "") +
              std::to_string(entry.last_write_time().time_since_epoch().count()) + "\n";
    return text;
  };
  const std::string before = facts();
  {
    const Viewer viewer(folder, "r");
    for (const char* name :
         {"", "api/state", "api/scene", "api/frames?first=0&count=7", "api/stats?from=0"})
      EXPECT_EQ(viewer.get(name).status, 200);
  }
  EXPECT_EQ(facts(), before);
}

TEST(View, TellsRunningFromKilledFromResumed) {
  const WorkFolder folder;
  folder.file("small.toml", small_scene());
  std::filesystem::create_directories(folder / "r");
  const Viewer viewer(folder, "r");
  EXPECT_EQ(viewer.status(), "empty");
  EXPECT_EQ(viewer.get("api/scene").status, 404);
  std::string first_run;
  int frames = 0;
  {
    const RunningProgram run(folder, {"run", "small.toml", "--frames", "100000", "--quiet",
                                      "--no-picture", "--out", "r"});
    EXPECT_TRUE(
        RunningProgram::wait_until([&] { return viewer.json("api/state").at("frames") > 5; }));
    const Json state = viewer.json("api/state");
    EXPECT_EQ(state.at("status"), "running");
    first_run = state.at("run");
    frames = state.at("frames");
    EXPECT_TRUE(
        RunningProgram::wait_until([&] { return viewer.json("api/state").at("frames") > frames; }));
    const std::string stats = viewer.get("api/stats?from=0").body;
    EXPECT_EQ(stats.back(), '\n');
    run.send(SIGKILL);
    run.wait();
  }
  const Json killed = viewer.json("api/state");
  EXPECT_EQ(killed.at("status"), "crashed");
  EXPECT_EQ(killed.at("run"), first_run);
  EXPECT_GT(killed.at("frames"), frames);
  EXPECT_EQ(viewer.get("api/frames?first=0&count=1").body.size(), 72u * 12);
  {
    const RunningProgram run(folder, {"resume", "r", "--quiet", "--no-picture"});
    EXPECT_TRUE(RunningProgram::wait_until([&] { return viewer.status() == "running"; }));
    EXPECT_EQ(viewer.json("api/state").at("run"), first_run);
    EXPECT_NE(viewer.json("api/state").at("stats"), killed.at("stats"));
    // A second simulator into the same folder is refused while the first one runs.
    EXPECT_EQ(taut(folder, {"resume", "r", "--quiet"}).exit_code, 1);
    EXPECT_EQ(taut(folder, {"run", "small.toml", "--quiet", "--out", "r"}).exit_code, 1);
    EXPECT_EQ(viewer.status(), "running");
    run.send(SIGINT);
    run.wait();
  }
  EXPECT_EQ(viewer.status(), "interrupted");
  ASSERT_EQ(taut(folder, {"run", "small.toml", "--quiet", "--no-picture", "--out", "r"}).exit_code,
            0);
  const Json anew = viewer.json("api/state");
  EXPECT_EQ(anew.at("status"), "finished");
  EXPECT_EQ(anew.at("frames"), 7);
  EXPECT_NE(anew.at("run"), first_run);
}

TEST(View, SaysWhatIsWrongAtTheStart) {
  const WorkFolder folder;
  std::filesystem::create_directories(folder / "r");
  const ProgramEnd missing = taut(folder, {"view", "nowhere", "--no-open"});
  EXPECT_EQ(missing.exit_code, 1);
  EXPECT_NE(missing.err.find("nowhere: there is no such folder"), std::string::npos) << missing.err;
  const Viewer viewer(folder, "r");
  const ProgramEnd taken =
      taut(folder, {"view", "r", "--no-open", "--port", std::to_string(viewer.port)});
  EXPECT_EQ(taken.exit_code, 1);
  EXPECT_NE(taken.err.find("--port"), std::string::npos) << taken.err;
  ::setenv("TAUT_VIEWER", (folder / "r").c_str(), 1);
  EXPECT_EQ(taut(folder, {"view", "r", "--no-open"}).exit_code, 1);
}

}  // namespace
}  // namespace taut::test
