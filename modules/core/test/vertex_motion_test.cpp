#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <stdexcept>

#include "mien/core/arkit.h"
#include "mien/core/motion.h"
#include "mien/core/rig_controls.h"

namespace mien {
namespace {

TEST(VertexMotion, CountsItsChannelsWithoutNames) {
  const Motion motion = vertex_motion({"square", 2}, 25, {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11});
  EXPECT_TRUE(motion.channels.empty());
  EXPECT_EQ(motion.num_channels(), 6);
  EXPECT_EQ(motion.num_frames(), 2);
  EXPECT_EQ(motion.frame(1)[0], 6);
  EXPECT_EQ(motion.channel_name(4), "vertex 1 y");
  EXPECT_FALSE(motion.find("vertex 1 y"));
  EXPECT_DOUBLE_EQ(motion.seconds(), 0.08);
  std::vector<Vec3> points(2);
  copy_positions(motion, 1, points);
  EXPECT_EQ(points[1], (Vec3{9, 10, 11}));
}

TEST(VertexMotion, IsResampledAndKeepsItsTopology) {
  const Motion motion = resample(vertex_motion({"point", 1}, 25, {0, 0, 0, 1, 2, 3}), 50);
  EXPECT_EQ(motion.topology, (Topology{"point", 1}));
  ASSERT_EQ(motion.num_frames(), 4);
  EXPECT_FLOAT_EQ(motion.frame(1)[2], 1.5f);
}

TEST(VertexMotion, MayHaveNoFramesButNeverHalfOnes) {
  EXPECT_EQ(vertex_motion({"point", 1}, 25).num_frames(), 0);
  EXPECT_THROW((void)vertex_motion({"point", 1}, 25, {0, 0}), std::logic_error);
  EXPECT_THROW((void)vertex_motion({"nothing", 0}, 25), std::logic_error);
  EXPECT_EQ((Motion{MotionSpace::vertices, {}, 25, {}}).num_frames(), 0);
}

TEST(Topology, IsKnownByItsNumberOfVertices) {
  EXPECT_EQ(topology_of(23370).name, "biwi");
  EXPECT_EQ(topology_of(5023).name, "flame");
  EXPECT_EQ(topology_of(6172).name, "multiface");
  EXPECT_EQ(topology_of(7).name, "");
  EXPECT_EQ(known_topology(23370)->fps, 25);
}

TEST(RigControls, HaveTheChannelsOfTheSpecification) {
  const auto names = uudamm_controls();
  ASSERT_EQ(names.size(), kNumUudamm);
  EXPECT_EQ(std::set(names.begin(), names.end()).size(), kNumUudamm);
  EXPECT_EQ(names[0], "lf_eyesocket_in");
  EXPECT_EQ(names[20], "lf_upperlid");
  EXPECT_EQ(names[31], "rt_eyesocket_in");
  EXPECT_EQ(names[33], "rt_eyeball.1");
  EXPECT_EQ(names[61], "rt_eyebrows1-4.7");
  EXPECT_EQ(names[76], "lf_sneer.0");
  EXPECT_EQ(names[108], "lf_cornerlip.0");
  EXPECT_EQ(names[146], "rt_chin.0");
  EXPECT_EQ(names[163], "rt_mouthcorner.0");
  EXPECT_EQ(names[166], "cn_jaw.0");
  EXPECT_EQ(names[178], "nose.0");
  EXPECT_EQ(names[191], "cn_lowlip.2");
  EXPECT_EQ(uudamm_mouth().size(), 61u);
}

TEST(RigControls, NameBeatsMouthWithoutTheJaw) {
  const auto names = arkit_order(ArkitOrder::beat);
  ASSERT_EQ(names.size(), 51u);
  EXPECT_EQ(names.back(), "noseSneerRight");
  for (const std::size_t c : beat_mouth()) {
    EXPECT_NE(names[c], "jawOpen");
    EXPECT_TRUE(names[c].starts_with("mouth") || names[c].starts_with("jaw")) << names[c];
  }
  for (const std::size_t c : beat_upper_face())
    EXPECT_TRUE(names[c].starts_with("eye") || names[c].starts_with("noseSneer")) << names[c];
}

}  // namespace
}  // namespace mien
