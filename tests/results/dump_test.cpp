#include "taut/results/dump.h"

#include <gtest/gtest.h>

#include <set>

#include "io/temporary_folder.h"
#include "results/dump_files.h"
#include "taut/base/error.h"
#include "taut/io/obj.h"
#include "taut/results/system_files.h"
#include "taut/scene/scene_file.h"
#include "taut/solve/linear_system.h"
#include "taut/solve/solver.h"

namespace taut {
namespace {

using test::DumpFiles;
using test::Matrix;
using test::Vector;

struct DumpCase {
  std::string name, scene;
  int step = 1;
  Vec3 wind = Vec3::Zero();
  std::string unknown = "dv";
  bool touches = false;
  std::string core = "stretch";
};
void PrintTo(const DumpCase& c, std::ostream* out) { *out << c.name; }

// A sheet of 7 x 6 nodes on two pinned corners, above a sphere where `ball` is set.
std::string sheet(const std::string& time, const std::string& cloth, const std::string& rest) {
  return "[time]\nstep = 4e-3\nframes = 40\n" + time +
         "\n[[cloth]]\ngrid = { nodes = [7, 6], origin = [-0.3, -0.25, 0.31], u = [0.6, 0, 0], v = "
         "[0, 0.5, 0.02] }\nnode_mass = "
         "1e-3\njitter = 2e-3\n" +
         cloth +
         "\n[[cloth.pin]]\ncorners = [\"u0v0\"]\n[[cloth.pin]]\ncorners = [\"u1v1\"]\n"
         "key_frames = [{ time = 0 }, { time = 0.1, translation = [0.05, 0, 0.05] }]\n" +
         rest;
}

const std::string stiff = "k_stretch = 300\nk_shear = 5\nk_bend = 0.4\n";
const std::string damped =
    stiff + "k_damp_stretch = 0.02\nk_damp_shear = 0.01\nk_damp_bend = 0.004\ndrag = 1e-4\n";
const std::string ball =
    "[[solid]]\nshape = \"sphere\"\nradius = 0.3\nfriction = 0.2\nvelocity = [0.4, 0, 0]\n";

std::vector<DumpCase> dump_cases() {
  const std::string choi_ko =
      "k_stretch = 300\nk_shear = 5\nk_bend = 2e-4\nbend_model = \"choi_ko\"\nk_damp_stretch = "
      "0.02\n";
  return {
      {"euler_slack", sheet("", damped, ""), 9},
      {"euler_linear_compression", sheet("", stiff + "compression = \"linear\"\n", ""), 12},
      {"euler_choi_ko", sheet("", choi_ko, ""), 15},
      {"euler_wind",
       sheet("", stiff + "wind_pressure = 0.5\ndrag = 1e-4\n", "[wind]\nvelocity = [3, 1, 0.5]\n"),
       6, Vec3(3, 1, 0.5)},
      {"core_auto", sheet("", damped, ""), 9, Vec3::Zero(), "dv", false, "auto"},
      {"euler_contact", sheet("", damped, ball), 25, Vec3::Zero(), "dv", true},
      {"imex", sheet("integrator = \"imex\"", damped, ""), 9},
      {"imex_contact", sheet("integrator = \"imex\"", damped + "compression = \"linear\"\n", ball),
       25, Vec3::Zero(), "dv", true},
      // Step limits by Σ (h² k + 2 h d)/m <= 1 a node: the weak bending springs are explicit, the
      // shear springs implicit but at the corners.
      {"imex_adaptive", sheet("integrator = \"imex_adaptive\"", damped, ""), 9},
      {"bdf2_first_step", sheet("integrator = \"bdf2\"", damped, ""), 1},
      {"bdf2", sheet("integrator = \"bdf2\"", damped + "compression = \"linear\"\n", ""), 8,
       Vec3::Zero(), "dx"},
      {"bdf2_choi_ko_wind",
       sheet("integrator = \"bdf2\"", choi_ko + "wind_pressure = 0.5\n",
             "[wind]\nvelocity = [0, 2, 1]\n"),
       8, Vec3(0, 2, 1), "dx"},
      {"bdf2_contact", sheet("integrator = \"bdf2\"", damped, ball), 25, Vec3::Zero(), "", true},
      {"mesh",
       "[time]\nstep = 4e-3\n[[cloth]]\nmesh = \"cloth.obj\"\ndensity = 0.2\njitter = 1e-3\n" +
           damped + "[[cloth.pin]]\nnodes = [0, 3]\n",
       10},
  };
}

// The dump of each case is made once.
class Dump : public testing::TestWithParam<DumpCase> {
 protected:
  static const DumpFiles& dump(const DumpCase& c) {
    static std::map<std::string, std::unique_ptr<DumpFiles>> made;
    auto& files = made[c.name];
    if (files) return *files;
    static const test::TemporaryFolder folder;
    GridShape shape;
    shape.nu = 6, shape.nv = 5, shape.u = Vec3(0.5, 0, 0), shape.v = Vec3(0, 0.4, 0);
    write_obj(folder / "cloth.obj", make_grid(shape));
    // Not auto: what it takes depends on the solves before.
    const std::vector<std::string> settings{"solver.name=core_fast", "solver.tolerance=1e-9",
                                            "solver.core=" + c.core};
    SceneSimulation simulation(read_scene_text(c.scene, folder / "scene.toml", settings));
    const DumpOutcome outcome = dump_step(simulation, c.step, folder / c.name);
    EXPECT_TRUE(outcome.status.ok()) << outcome.status.message;
    files = std::make_unique<DumpFiles>(folder / c.name);
    return *files;
  }
  const DumpFiles& d = dump(GetParam());
  const double h = d.meta.at("h");
  const bool is_dx = d.meta.at("unknown") == "dx";
  const bool imex = d.meta.at("integrator") == "imex";
  const double c_k = is_dx ? 4 * h * h / 9 : h * h, c_d = is_dx ? 2 * h / 3 : h;

  // Of the springs that the integrator treats implicitly.
  test::SpringSums implicit() const {
    test::SpringSums sums = test::sum_springs(d, "stretch");
    if (imex) return sums;
    for (const char* name : {"shear", "bend"}) {
      const test::SpringSums more = test::sum_springs(d, name, true);
      sums.k += more.k, sums.d += more.d;
    }
    return sums;
  }
};

// Largest |a - b| relative to sqrt(b_ii b_jj), which bounds a positive definite matrix's entries.
double scaled_difference(const Matrix& a, const Matrix& b) {
  const Vector scale = b.diagonal().cwiseAbs().cwiseSqrt().cwiseMax(1e-300);
  return (scale.cwiseInverse().asDiagonal() * (a - b) * scale.cwiseInverse().asDiagonal())
      .cwiseAbs()
      .maxCoeff();
}

TEST_P(Dump, IsTheCaseThatItIsMeantToBe) {
  if (!GetParam().unknown.empty()) {
    EXPECT_EQ(d.meta.at("unknown"), GetParam().unknown);
  }
  EXPECT_EQ(d.has("x_prev"), is_dx);
  EXPECT_EQ(d.meta.at("step"), GetParam().step);
  const auto by_ndof = d.meta.at("nodes_by_ndof");
  EXPECT_EQ(by_ndof[2].get<int>() > 0, GetParam().touches);
  EXPECT_EQ(d.friction.norm() > 0.0, GetParam().touches);
  EXPECT_GE(by_ndof[0], 2);
  EXPECT_EQ(d.u.cols(),
            by_ndof[1].get<int>() + 2 * by_ndof[2].get<int>() + 3 * by_ndof[3].get<int>());
}

TEST_P(Dump, SolutionAgreesWithADirectSolve) {
  const Matrix reduced = d.u.transpose() * d.a * d.u;
  const Vector prescribed = d.z - d.s * d.z;
  const Vector y = reduced.llt().solve(d.u.transpose() * (d.b - d.a * prescribed));
  const Vector expected = d.u * y + prescribed, error = d.dv - expected;
  EXPECT_LT(std::sqrt(error.dot(d.a * error)), 1e-6 * std::sqrt(y.dot(reduced * y)));
  EXPECT_LT((d.dv - d.s * d.dv - prescribed).norm(), 1e-12 * d.dv.norm());
}

TEST_P(Dump, FramesAreOrthonormalAndSpanTheProjection) {
  EXPECT_LT(
      (d.u.transpose() * d.u - Matrix::Identity(d.u.cols(), d.u.cols())).cwiseAbs().maxCoeff(),
      1e-12);
  EXPECT_LT((d.u * d.u.transpose() - d.s).cwiseAbs().maxCoeff(), 1e-12);
}

TEST_P(Dump, MatrixFollowsFromTheSprings) {
  const test::SpringSums springs = implicit();
  const Matrix expected =
      Matrix(d.m.asDiagonal()) + c_d * (d.d_external + springs.d) + c_k * springs.k;
  EXPECT_LT(scaled_difference(d.a, expected), 1e-9);
}

TEST_P(Dump, StiffnessOfEachClassFollowsFromTheSprings) {
  for (const std::string name : {"stretch", "shear", "bend"}) {
    const Matrix expected = test::sum_springs(d, name).k;
    EXPECT_EQ(d.has("K_" + name),
              expected.size() > 0 && (GetParam().name != "mesh" || name != "shear"))
        << name;
    if (!d.has("K_" + name)) continue;
    EXPECT_LT((d.matrix("K_" + name) - expected).cwiseAbs().maxCoeff(),
              1e-9 * expected.cwiseAbs().maxCoeff())
        << name;
  }
}

TEST_P(Dump, CoreIsMadeOfBlocksOfTheMatrix) {
  EXPECT_EQ(d.meta.at("core"), GetParam().core);
  std::set<std::pair<int, int>> kept;
  if (GetParam().core == "auto") {
    // Which springs are strong is tests/solve/core_choice_test.cpp's; here: whole blocks, both
    // triangles, and some of each kind.
    int left_out = 0;
    for (const test::SpringRow& s : d.springs) {
      const bool is_kept = !d.a_core.block<3, 3>(3 * s.i, 3 * s.j).isZero(0.0);
      if (is_kept) kept.insert({s.i, s.j}), kept.insert({s.j, s.i});
      left_out += !is_kept;
    }
    EXPECT_FALSE(kept.empty());
    EXPECT_GT(left_out, 0);
  }
  for (const test::SpringRow& s : d.springs)
    if (GetParam().core == "stretch" && s.force_class == "stretch")
      kept.insert({s.i, s.j}), kept.insert({s.j, s.i});
  for (int i = 0; i < d.m.size() / 3; ++i)
    for (int j = 0; j < d.m.size() / 3; ++j) {
      const Mat3 expected = i == j || kept.contains({i, j}) ? Mat3(d.a.block<3, 3>(3 * i, 3 * j))
                                                            : Mat3(Mat3::Zero());
      EXPECT_EQ(Mat3(d.a_core.block<3, 3>(3 * i, 3 * j)), expected) << i << " " << j;
    }
}

TEST_P(Dump, ForceFollowsFromTheSprings) {
  Vector expected = d.d_external * (GetParam().wind.replicate(d.m.size() / 3, 1) - d.v);
  for (Eigen::Index i = 2; i < d.m.size(); i += 3) expected[i] -= 9.81 * d.m[i];
  for (const char* name : {"stretch", "shear", "bend"}) expected += test::sum_springs(d, name).f;
  EXPECT_LT((d.f_start - expected).norm(), 1e-10 * expected.norm());
}

TEST_P(Dump, RightHandSideFollowsFromForceAndState) {
  const test::SpringSums springs = implicit();
  Vector expected;
  if (is_dx) {
    const Vector delta = d.x - d.vector("x_prev"), v_prev = d.vector("v_prev");
    const Matrix damping = d.d_external + springs.d;
    expected = d.m.cwiseProduct(delta / 3 + h / 9 * (8 * d.v - 2 * v_prev)) +
               4 * h * h / 9 * (d.f_start + damping * d.v) + 2 * h / 9 * (damping * delta) +
               4 * h / 9 * d.friction;
  } else {
    expected = h * (d.f_start - h * springs.k * d.v) + d.friction;
  }
  EXPECT_LT((d.b - expected).norm(), 1e-9 * expected.norm());
}

TEST_P(Dump, SystemReadBackIsSolvedInTheSameIterations) {
  const StoredSystem stored(files_of_dump(d.folder));
  const LinearSystem system = stored.system();
  std::vector<double> x(system.rhs.size());
  const SolveSummary summary =
      make_solver({.name = d.meta.at("solver"), .tolerance = d.meta.at("tolerance")})
          ->solve(system, x);
  EXPECT_TRUE(summary.status.ok());
  EXPECT_EQ(summary.iterations, d.meta.at("iterations"));
  EXPECT_LT((Eigen::Map<const Vector>(x.data(), d.dv.size()) - d.dv).norm(), 1e-9 * d.dv.norm());
}

INSTANTIATE_TEST_SUITE_P(Cases, Dump, testing::ValuesIn(dump_cases()),
                         [](const auto& item) { return item.param.name; });

TEST(DumpFolder, RefusesOthersFilesAndReplacesItsOwn) {
  const test::TemporaryFolder folder;
  SceneSimulation simulation(read_scene_text(dump_cases()[0].scene, folder / "scene.toml"));
  ASSERT_TRUE(dump_step(simulation, 1, folder / "dump").status.ok());
  const auto first = read_file(folder / "dump/dv.mtx");
  ASSERT_TRUE(dump_step(simulation, 2, folder / "dump").status.ok());
  EXPECT_NE(first, read_file(folder / "dump/dv.mtx"));
  write_file(folder / "dump/notes.txt", "mine");
  const auto kept = read_file(folder / "dump/dv.mtx");
  try {
    dump_step(simulation, 3, folder / "dump");
    FAIL() << "wrote into a folder with somebody's notes";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("notes.txt"), std::string::npos) << error.what();
  }
  EXPECT_EQ(simulation.steps_done(), 2);  // refused before the work, not after
  EXPECT_EQ(kept, read_file(folder / "dump/dv.mtx"));
}

}  // namespace
}  // namespace taut
