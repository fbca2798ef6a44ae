#include "mien/io/gltf_animation.h"

#include <cmath>
#include <functional>
#include <numbers>

#include "io_test_support.h"
#include "mien/base/random.h"
#include "mien/core/arkit.h"
#include "mien/io/gltf_reader.h"
#include "mien/io/gltf_writer.h"

namespace mien {
namespace {

using namespace test;

Motion talk(std::vector<std::string> channels, std::int64_t num_frames, double fps = 60) {
  Motion motion{MotionSpace::arkit, std::move(channels), fps, {}};
  Rng rng(11);
  for (std::int64_t n = 0; n < num_frames; ++n)
    for (const auto& channel : motion.channels)
      motion.values.push_back(
          static_cast<float>(channel.starts_with("head") ? rng.uniform(-20, 20) : rng.uniform()));
  return motion;
}

template <class T = float>
std::vector<T> accessor_data(const Glb& glb, std::size_t accessor, std::size_t width) {
  const Json& entry = glb.json["accessors"][accessor];
  const Json& view = glb.json["bufferViews"][entry["bufferView"].get<std::size_t>()];
  std::vector<T> out(entry["count"].get<std::size_t>() * width);
  EXPECT_EQ(view["byteLength"].get<std::size_t>(), out.size() * sizeof(T));
  std::memcpy(out.data(), glb.bin.data() + view["byteOffset"].get<std::size_t>(), out.size() * sizeof(T));
  return out;
}

const Json& sampler_of(const Glb& glb, const char* path, std::size_t node) {
  const Json& animation = glb.json["animations"].back();
  for (const Json& channel : animation["channels"])
    if (channel["target"]["path"] == path && channel["target"]["node"] == node)
      return animation["samplers"][channel["sampler"].get<std::size_t>()];
  static const Json nothing;
  ADD_FAILURE() << "no " << path << " channel for node " << node;
  return nothing;
}

// The direction in which a rotation sends v.
Vec3 rotate(const float* q, Vec3 v) {
  const Vec3 axis = {q[0], q[1], q[2]};
  const Vec3 t = 2.0f * cross(axis, v);
  return v + q[3] * t + cross(axis, t);
}

TEST(GltfAnimation, DrivesAllTargetsOfAMeshTogether) {
  const Motion motion = talk({"mouthClose", "JawOpen", "tongueOut"}, 5);
  const auto bytes = animate_glb(*write_glb(tiny_character()), motion, "hello.wav");
  ASSERT_TRUE(bytes) << bytes.error().message();
  const Glb glb = open_glb(*bytes);
  ASSERT_EQ(glb.json["animations"].size(), 1u);
  const Json& animation = glb.json["animations"][0];
  EXPECT_EQ(animation["extras"]["audio"], "hello.wav");
  EXPECT_EQ(animation["extras"]["fps"], 60.0);
  const Json& sampler = sampler_of(glb, "weights", 1);
  const auto times = accessor_data(glb, sampler["input"].get<std::size_t>(), 1);
  ASSERT_EQ(times.size(), 5u);
  for (std::size_t n = 0; n < 5; ++n) EXPECT_FLOAT_EQ(times[n], static_cast<float>(n) / 60.0f);
  EXPECT_EQ(glb.json["accessors"][sampler["input"].get<std::size_t>()]["max"][0].get<float>(), times[4]);
  // Targets: eyeLookUpLeft, jawOpen, mouthClose, bulge.
  const auto weights = accessor_data(glb, sampler["output"].get<std::size_t>(), 1);
  ASSERT_EQ(weights.size(), 20u);
  for (std::int64_t n = 0; n < 5; ++n) {
    EXPECT_EQ(weights[4 * n], 0.0f);
    EXPECT_EQ(weights[4 * n + 1], motion.frame(n)[1]);
    EXPECT_EQ(weights[4 * n + 2], motion.frame(n)[0]);
    EXPECT_EQ(weights[4 * n + 3], 0.0f);
  }
  ASSERT_EQ(bytes.warnings.size(), 2u);
  EXPECT_EQ(bytes.warnings[0], "channels without a morph target: tongueOut");
  EXPECT_EQ(bytes.warnings[1], "morph targets that the motion does not drive: bulge, eyeLookUpLeft");
}

TEST(GltfAnimation, KeepsTheRestOfTheFile) {
  Glb user = open_glb(*write_glb(tiny_character()));
  user.json["extensionsUsed"] = {"ACME_unknown"};
  user.json["extensions"]["ACME_unknown"] = {{"deep", {1, 2, {{"x", 0.1}}}}};
  user.json["materials"][0]["extras"]["note"] = "kept";
  user.json["images"] = Json::array({{{"uri", "data:image/png;base64,AAAA"}}});
  user.json["animations"] = Json::array(
      {{{"name", "idle"},
        {"channels", Json::array({{{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}}})},
        {"samplers", Json::array({{{"input", 0}, {"output", 0}}})}}});
  user.json["meshes"][0]["weights"] = {0, 0, 0, 0.25};
  const Bytes input = make_glb(user.json, user.bin);
  const auto bytes = animate_glb(input, talk({"jawOpen"}, 3), "");
  ASSERT_TRUE(bytes) << bytes.error().message();
  Glb out = open_glb(*bytes);
  // Everything that was there is there, in its place.
  for (const auto& [key, value] : user.json.items()) {
    if (key == "buffers") continue;
    if (!value.is_array()) {
      EXPECT_EQ(out.json[key], value) << key;
      continue;
    }
    for (std::size_t i = 0; i < value.size(); ++i) EXPECT_EQ(out.json[key][i], value[i]) << key << i;
  }
  EXPECT_TRUE(std::equal(user.bin.begin(), user.bin.end(), out.bin.begin()));
  EXPECT_EQ(out.json["animations"].size(), 2u);
  EXPECT_FALSE(out.json["animations"][1]["extras"].contains("audio"));
  // A target that nothing drives keeps its default weight.
  const auto weights = accessor_data(out, sampler_of(out, "weights", 1)["output"].get<std::size_t>(), 1);
  EXPECT_EQ(weights[3], 0.25f);
  // The added animation is the one that is read back.
  const auto read = read_glb_motion(*bytes);
  ASSERT_TRUE(read) << read.error().message();
  EXPECT_EQ(read->num_frames(), 3);
}

TEST(GltfAnimation, RoundTripIsExact) {
  auto channels = arkit_and_head_channels();
  Character character = tiny_character();
  character.parts[0].shapes.clear();
  for (const auto name : arkit_names())
    character.parts[0].shapes.push_back({std::string(name), {1}, {{0, 1, 0}}, {}});
  const Bytes face = *write_glb(character);
  for (const double fps : {60.0, 24.0, 30000.0 / 1001}) {
    const Motion motion = talk(channels, 130, fps);
    const auto read = read_glb_motion(*animate_glb(face, motion, "a.wav"));
    ASSERT_TRUE(read) << read.error().message();
    EXPECT_EQ(read->channels, motion.channels);
    EXPECT_EQ(read->fps, fps);
    ASSERT_EQ(read->values.size(), motion.values.size());
    for (std::size_t i = 0; i < motion.values.size(); ++i) {
      if (i % 55 < 52)
        ASSERT_EQ(read->values[i], motion.values[i]) << i;
      else
        ASSERT_NEAR(read->values[i], motion.values[i], 2e-5) << i;
    }
  }
}

TEST(GltfAnimation, QuantisedWeightsAreHalfTheSizeAndClose) {
  Motion motion = talk({"jawOpen", "mouthClose"}, 50);
  motion.values[0] = 1.5f;
  motion.values[1] = -0.5f;
  const Bytes face = *write_glb(tiny_character());
  const auto bytes = animate_glb(face, motion, "", {.quantised = true});
  ASSERT_TRUE(bytes);
  EXPECT_LT(bytes->size(), animate_glb(face, motion, "")->size());
  const auto read = read_glb_motion(*bytes);
  ASSERT_TRUE(read) << read.error().message();
  ASSERT_EQ(read->channels, (std::vector<std::string>{"eyeLookUpLeft", "jawOpen", "mouthClose"}));
  EXPECT_EQ(read->frame(0)[1], 1.0f);
  EXPECT_EQ(read->frame(0)[2], 0.0f);
  for (std::int64_t n = 1; n < 50; ++n)
    for (std::size_t c = 0; c < 2; ++c)
      EXPECT_NEAR(read->frame(n)[c + 1], motion.frame(n)[c], 0.5 / 65535 + 1e-7);
}

TEST(GltfAnimation, HeadTurnsTheWayTheAnglesSay) {
  const Bytes face = *write_glb(tiny_character());
  const auto turned = [&](float yaw, float pitch, float roll, Vec3 v) {
    const Motion motion{
        MotionSpace::arkit, {"jawOpen", "headYaw", "headPitch", "headRoll"}, 60, {0, yaw, pitch, roll}};
    const Glb glb = open_glb(*animate_glb(face, motion, ""));
    const auto q = accessor_data(glb, sampler_of(glb, "rotation", 0)["output"].get<std::size_t>(), 4);
    return rotate(q.data(), v);
  };
  // + is to the subject's left (+x), up, right ear (-x) down.
  EXPECT_LT(length(turned(90, 0, 0, {0, 0, 1}) - Vec3{1, 0, 0}), 1e-6f);
  EXPECT_LT(length(turned(0, 90, 0, {0, 0, 1}) - Vec3{0, 1, 0}), 1e-6f);
  EXPECT_LT(length(turned(0, 0, 90, {-1, 0, 0}) - Vec3{0, -1, 0}), 1e-6f);
}

TEST(GltfAnimation, KeysGoTheShortWayRound) {
  // Yaw 170 and -170 degrees are 20 degrees apart; their plain quaternions lie on opposite sides.
  const Motion motion{MotionSpace::arkit, {"jawOpen", "headYaw"}, 60, {0, 170, 0, -170}};
  const Glb glb = open_glb(*animate_glb(*write_glb(tiny_character()), motion, ""));
  const auto q = accessor_data(glb, sampler_of(glb, "rotation", 0)["output"].get<std::size_t>(), 4);
  EXPECT_NEAR(q[0] * q[4] + q[1] * q[5] + q[2] * q[6] + q[3] * q[7], std::cos(10 * std::numbers::pi / 180),
              1e-6);
}

TEST(GltfAnimation, HeadJointKeepsItsRestPoseAndAxes) {
  // A neck that points sideways and a head joint with a rest rotation given as a matrix.
  Glb user = open_glb(*write_glb(tiny_character()));
  const double h = std::sqrt(0.5);
  user.json["nodes"][0]["name"] = "Group";
  user.json["nodes"].push_back({{"name", "neck"}, {"rotation", {0, 0, h, h}}, {"children", {4}}});
  user.json["nodes"].push_back(
      {{"name", "mixamorig:Head"}, {"matrix", {1, 0, 0, 0, 0, 0, 1, 0, 0, -1, 0, 0, 1, 2, 3, 1}}});
  user.json["scenes"][0]["nodes"] = {0, 3};
  user.json["skins"] = Json::array({{{"joints", {3, 4}}}});
  const Bytes input = make_glb(user.json, user.bin);
  const Motion motion{
      MotionSpace::arkit, {"jawOpen", "headYaw", "headPitch", "headRoll"}, 60, {0, 30, -10, 5, 0, 0, 0, 0}};
  const auto bytes = animate_glb(input, motion, "");
  ASSERT_TRUE(bytes) << bytes.error().message();
  const Glb glb = open_glb(*bytes);
  const Json& node = glb.json["nodes"][4];
  EXPECT_FALSE(node.contains("matrix"));
  EXPECT_EQ(node["translation"], Json({1.0, 2.0, 3.0}));
  const auto q = accessor_data(glb, sampler_of(glb, "rotation", 4)["output"].get<std::size_t>(), 4);
  // Frame 1 is the rest pose: 90 degrees about x.
  EXPECT_NEAR(q[4], h, 1e-6);
  EXPECT_NEAR(q[7], h, 1e-6);
  // Frame 0 in the axes of the character: parent * q * rest^-1 * parent^-1 turns +z as yaw 30, pitch -10
  // does.
  const float parent[4] = {0, 0, static_cast<float>(h), static_cast<float>(h)};
  const float parent_back[4] = {0, 0, static_cast<float>(-h), static_cast<float>(h)};
  const float rest_back[4] = {static_cast<float>(-h), 0, 0, static_cast<float>(h)};
  const Vec3 got = rotate(parent, rotate(q.data(), rotate(rest_back, rotate(parent_back, {0, 0, 1}))));
  const double yaw = 30 * std::numbers::pi / 180, pitch = -10 * std::numbers::pi / 180;
  EXPECT_NEAR(got.x, std::sin(yaw) * std::cos(pitch), 1e-6);
  EXPECT_NEAR(got.y, std::sin(pitch), 1e-6);
  EXPECT_NEAR(got.z, std::cos(yaw) * std::cos(pitch), 1e-6);
  const auto read = read_glb_motion(*bytes);
  ASSERT_TRUE(read);
  EXPECT_NEAR(read->frame(0)[read->channels.size() - 3], 30, 1e-4);
  EXPECT_NEAR(read->frame(0)[read->channels.size() - 1], 5, 1e-4);
}

TEST(GltfAnimation, HeadNodeMustCarryTheFace) {
  Glb user = open_glb(*write_glb(tiny_character()));
  user.json["nodes"][0]["name"] = "Group";
  user.json["nodes"][2]["name"] = "Wolf_Head";  // the hair: turning it alone would tear the face apart
  const Motion motion = talk({"jawOpen", "headYaw"}, 2);
  const auto bytes = animate_glb(make_glb(user.json, user.bin), motion, "");
  ASSERT_TRUE(bytes);
  EXPECT_EQ(bytes.warnings[0], "the character has no head node or joint: head angles are left out");
  EXPECT_EQ(open_glb(*bytes).json["animations"][0]["channels"].size(), 1u);
}

TEST(GltfAnimation, HeadNodeMustStandNearTheFace) {
  // The tiny face is 0.1 m large: turning it about a point 0.09 m away is a head, about the floor is not.
  for (const auto& [height, turns] : {std::pair{-0.09, true}, {-1.6, false}}) {
    Glb user = open_glb(*write_glb(tiny_character()));
    user.json["nodes"][0]["translation"] = {0, height, 0};
    for (const std::size_t child : {1u, 2u}) user.json["nodes"][child]["translation"] = {0, -height, 0};
    const auto bytes = animate_glb(make_glb(user.json, user.bin), talk({"jawOpen", "headYaw"}, 2), "");
    ASSERT_TRUE(bytes);
    EXPECT_EQ(open_glb(*bytes).json["animations"][0]["channels"].size(), turns ? 2u : 1u) << height;
  }
}

TEST(GltfAnimation, NodesThatShareAMeshShareTheData) {
  Glb user = open_glb(*write_glb(tiny_character()));
  user.json["nodes"].push_back({{"mesh", 0}});
  user.json["nodes"][0]["children"].push_back(3);
  const auto bytes = animate_glb(make_glb(user.json, user.bin), talk({"jawOpen"}, 2), "");
  const Json animation = open_glb(*bytes).json["animations"][0];
  EXPECT_EQ(animation["channels"].size(), 2u);
  EXPECT_EQ(animation["samplers"].size(), 1u);
}

TEST(GltfAnimation, FilesWithoutBinaryChunkGetADataUri) {
  Json json = open_glb(*write_glb(tiny_character())).json;
  // Only names and counts matter for animating, so the buffer may be anything.
  json["buffers"][0]["uri"] = "face.bin";
  const std::string text = json.dump();
  const auto bytes = animate_glb(as_bytes(text), talk({"jawOpen"}, 2), "");
  ASSERT_TRUE(bytes) << bytes.error().message();
  const std::size_t json_size = *read_le<std::uint32_t>(*bytes, 12);
  EXPECT_EQ(bytes->size(), 20 + json_size);
  const Json out = Json::parse(as_text(std::span(*bytes).subspan(20)));
  ASSERT_EQ(out["buffers"].size(), 2u);
  EXPECT_TRUE(
      out["buffers"][1]["uri"].get<std::string>().starts_with("data:application/octet-stream;base64,"));
  EXPECT_NE(bytes.warnings.back().find("keep them beside it"), std::string::npos);
  // Embedded as well, it can be read back.
  json["buffers"][0] = {{"byteLength", 3}, {"uri", "data:;base64,AAAA"}};
  const auto read = read_glb_motion(*animate_glb(as_bytes(json.dump()), talk({"jawOpen"}, 2), ""));
  ASSERT_TRUE(read) << read.error().message();
  EXPECT_EQ(read->frame(0)[1], talk({"jawOpen"}, 2).values[0]);
}

TEST(GltfAnimation, ReadsOtherProgramsCurves) {
  Glb user = open_glb(*animate_glb(*write_glb(smallest_character()), talk({"jawOpen"}, 3, 2), ""));
  Json& animation = user.json["animations"][0];
  animation.erase("extras");
  // Keys at 0, 0.5 and 1 s of a single target: even, so the rate is theirs.
  EXPECT_EQ(read_glb_motion(make_glb(user.json, user.bin))->fps, 2);
  const auto set_output = [&](const std::vector<float>& values) {
    Bytes data;
    for (const float v : values) append_le(data, v);
    user.bin.resize((user.bin.size() + 3) / 4 * 4);
    user.json["bufferViews"].push_back(
        {{"buffer", 0}, {"byteOffset", user.bin.size()}, {"byteLength", data.size()}});
    user.bin.insert(user.bin.end(), data.begin(), data.end());
    user.json["buffers"][0]["byteLength"] = user.bin.size();
    user.json["accessors"].push_back({{"bufferView", user.json["bufferViews"].size() - 1},
                                      {"componentType", 5126},
                                      {"type", "SCALAR"},
                                      {"count", values.size()}});
    animation["samplers"][0]["output"] = user.json["accessors"].size() - 1;
  };
  animation["extras"]["fps"] = 8;
  set_output({0, 1, 0.5f});
  EXPECT_EQ(read_glb_motion(make_glb(user.json, user.bin))->values,
            (std::vector<float>{0, 0.25f, 0.5f, 0.75f, 1, 0.875f, 0.75f, 0.625f, 0.5f}));
  animation["samplers"][0]["interpolation"] = "STEP";
  EXPECT_EQ(read_glb_motion(make_glb(user.json, user.bin))->values,
            (std::vector<float>{0, 0, 0, 0, 1, 1, 1, 1, 0.5f}));
  // Hermite: from 0 to 1 with zero tangents is 0.5 in the middle; an out-tangent of 2 a second adds h10 * 0.5
  // * 2.
  animation["samplers"][0]["interpolation"] = "CUBICSPLINE";
  set_output({0, 0, 2, 4, 1, 0, 0, 1, 0});
  const auto cubic = read_glb_motion(make_glb(user.json, user.bin));
  ASSERT_TRUE(cubic);
  EXPECT_FLOAT_EQ(cubic->values[2], 0.5f + 0.125f - 0.25f);
  EXPECT_FLOAT_EQ(cubic->values[6], 1.0f);
  set_output({0, 3.3e38f, 3e38f, -3e38f, 3.3e38f, 0, 0, 1, 0});
  EXPECT_EQ(read_glb_motion(make_glb(user.json, user.bin)).error().code, Errc::input);  // infinite in between
  // One value too few.
  set_output({0, 0, 2, 0, 1, 0, 0, 1});
  EXPECT_FALSE(read_glb_motion(make_glb(user.json, user.bin)));
}

TEST(GltfAnimation, RefusesWhatDoesNotFit) {
  const Bytes face = *write_glb(tiny_character());
  const auto code = [&](const Motion& motion) { return animate_glb(face, motion, "").error().code; };
  EXPECT_EQ(code(talk({"jawOpen"}, 0)), Errc::input);
  EXPECT_EQ(code(talk({"tongueOut"}, 2)), Errc::incompatible);
  Motion vertices = talk({"jawOpen"}, 2);
  vertices.space = MotionSpace::vertices;
  EXPECT_EQ(code(vertices), Errc::incompatible);
  Motion broken = talk({"jawOpen", "mouthClose"}, 3);
  broken.values[3] = NAN;
  const auto error = animate_glb(face, broken, "").error();
  EXPECT_EQ(error.code, Errc::failed);
  EXPECT_NE(error.why.find("'mouthClose' is not finite at frame 1"), std::string::npos);
  EXPECT_EQ(read_glb_motion(face).error().code, Errc::incompatible);
  Json odd = open_glb(face).json;
  odd["animations"] = {{"not", "a list"}};
  EXPECT_EQ(animate_glb(make_glb(odd, {}), talk({"jawOpen"}, 2), "").error().code, Errc::input);
}

TEST(GltfAnimation, LongGapsCannotAskForMuchMemory) {
  Glb user = open_glb(*animate_glb(*write_glb(smallest_character()), talk({"jawOpen"}, 2, 60), ""));
  const Json& view =
      user.json["bufferViews"][user.json["accessors"][user.json["animations"][0]["samplers"][0]["input"]
                                                          .get<std::size_t>()]["bufferView"]
                                   .get<std::size_t>()];
  const float far = 1e9f;
  std::memcpy(user.bin.data() + view["byteOffset"].get<std::size_t>() + 4, &far, 4);
  EXPECT_EQ(read_glb_motion(make_glb(user.json, user.bin)).error().code, Errc::input);
}

TEST(GltfAnimation, SurvivesTruncationAndFlippedBytes) {
  const Bytes whole = *animate_glb(*write_glb(smallest_character(), {.normals = false}),
                                   talk({"jawOpen", "headYaw"}, 2), "a.wav");
  const auto never = [](std::size_t) { return false; };
  torture(
      whole, [](const Bytes& bytes) { return read_glb_motion(bytes).has_value(); }, never);
  const Motion motion = talk({"jawOpen", "headYaw"}, 2);
  torture(
      whole, [&](const Bytes& bytes) { return animate_glb(bytes, motion, "").has_value(); }, never);
}

TEST(GltfAnimation, SurvivesEveryValueReplacedOrErased) {
  const Motion motion = talk({"jawOpen", "headYaw"}, 2);
  Glb whole = open_glb(*animate_glb(*write_glb(smallest_character()), motion, "a.wav"));
  whole.json["skins"] = Json::array({{{"joints", {0}}}});
  const Json hostile[] = {Json(),
                          -1,
                          0,
                          1,
                          3,
                          65535,
                          4294967295u,
                          18446744073709551615u,
                          1e300,
                          0.5,
                          true,
                          "x",
                          Json::array(),
                          Json::array({0, 0}),
                          Json::object()};
  const auto survive = [&](const Json& json) {
    const Bytes bytes = make_glb(json, whole.bin);
    (void)read_glb(bytes);
    (void)read_glb_motion(bytes);
    (void)animate_glb(bytes, motion, "");
  };
  std::vector<Json::json_pointer> places;
  const std::function<void(const Json&, const Json::json_pointer&)> collect =
      [&](const Json& at, const Json::json_pointer& path) {
        if (!path.empty()) places.push_back(path);
        if (at.is_object())
          for (const auto& [key, value] : at.items()) collect(value, path / key);
        if (at.is_array())
          for (std::size_t i = 0; i < at.size(); ++i) collect(at[i], path / i);
      };
  collect(whole.json, Json::json_pointer());
  EXPECT_GT(places.size(), 150u);
  for (const auto& place : places) {
    for (const Json& value : hostile) {
      Json damaged = whole.json;
      damaged[place] = value;
      survive(damaged);
    }
    Json damaged = whole.json;
    Json& parent = damaged[place.parent_pointer()];
    if (parent.is_object())
      parent.erase(place.back());
    else
      parent.erase(static_cast<std::size_t>(std::stoul(place.back())));
    survive(damaged);
  }
}

TEST(GltfAnimation, NamesThatAreNotUtf8DoNotBreakTheFile) {
  const auto bytes = animate_glb(*write_glb(tiny_character()), talk({"jawOpen"}, 1), "caf\xe9.wav");
  ASSERT_TRUE(bytes);
  EXPECT_EQ(open_glb(*bytes).json["animations"][0]["extras"]["audio"], "caf\xef\xbf\xbd.wav");
}

TEST(GltfAnimation, ManyHoursFitOnlyWhenTheFormatHoldsThem) {
  // 3 GiB of weights would be needed: refused before anything of that size is allocated.
  Character character = smallest_character();
  for (int i = 0; i < 2000; ++i)
    character.parts[0].shapes.push_back({"x" + std::to_string(i), {0}, {{1, 0, 0}}, {}});
  const Motion motion{MotionSpace::arkit, {"jawOpen"}, 60, std::vector<float>(600000)};
  const auto bytes = animate_glb(*write_glb(character, {.normals = false}), motion, "");
  ASSERT_FALSE(bytes);
  EXPECT_EQ(bytes.error().code, Errc::failed);
}

}  // namespace
}  // namespace mien
