#include "taut/contact/solid_obstacles.h"

#include "contact/point_masses.h"

namespace taut {
namespace {

using test::plane;
using test::sphere;
constexpr double h = 0.01, touch = 1e-6;

TEST(SolidObstacles, firstOneInTheWayAndItsPlane) {
  SolidObstacles obstacles({sphere(1.0, 0.1), plane(Vec3::UnitZ(), 0.2, Vec3(0, 0, -0.5))}, 2,
                           touch, {{0, 1}, {}});
  const std::vector<Vec3> start = {Vec3(0, 0, 2), Vec3(0, 0, 2)};
  obstacles.begin_step(0.0, h, start);
  EXPECT_FALSE(obstacles.obstacle(0, Vec3(0, 0, 0.5)));  // it does not meet the ball
  EXPECT_FALSE(obstacles.obstacle(1, Vec3(0, 0, 1.0 - 1e-4)));
  const Obstacle ball = obstacles.obstacle(1, Vec3(0, 0.3, 0.4)).value();
  EXPECT_EQ(ball.solid, 0);
  EXPECT_LT((ball.normal - Vec3(0, 0.6, 0.8)).norm(), 1e-15);
  EXPECT_NEAR(ball.offset, 1.0, 1e-15);
  const Obstacle floor = obstacles.obstacle(0, Vec3(0, 0, -0.7)).value();
  EXPECT_EQ(floor.solid, 1);
  EXPECT_NEAR(floor.offset, -0.5, 1e-15);
  EXPECT_EQ(floor.friction, 0.2);
}

TEST(SolidObstacles, moveOutGoesToTheSurfaceOfEach) {
  for (const Vec3& inside : {Vec3(-0.2, 0.5, -0.1), Vec3(-0.1, 0.5, -0.2)}) {
    SolidObstacles obstacles({plane(Vec3::UnitZ()), plane(Vec3::UnitX())}, 1, touch);
    obstacles.begin_step(0.0, h, std::vector<Vec3>{Vec3(1, 1, 1)});
    Vec3 x = inside;
    EXPECT_NEAR(obstacles.move_out(0, x).value(), 0.2, 1e-15);  // the deeper of the two
    EXPECT_LT((x - Vec3(0, 0.5, 0)).norm(), 1e-15);
    EXPECT_FALSE(obstacles.move_out(0, x));
  }
}

TEST(SolidObstacles, motionChangesFromTheNextStepOn) {
  SolidObstacles obstacles({plane(Vec3::UnitZ(), 0.2)}, 1, touch);
  const std::vector<Vec3> start = {Vec3::Zero()};
  Solid rising = plane(Vec3::UnitZ());
  rising.velocity = Vec3(0.5, 0, 2.0);
  obstacles.set_motion(0, rising);
  obstacles.begin_step(0.0, h, start);
  const Obstacle floor = obstacles.obstacle(0, start[0]).value();
  EXPECT_NEAR(floor.offset, 2.0 * h, 1e-15);
  EXPECT_LT((floor.carried - h * rising.velocity).norm(), 1e-15);
  EXPECT_EQ(floor.friction, 0.2);  // only its motion was replaced
}

}  // namespace
}  // namespace taut
