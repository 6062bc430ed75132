// What every format promises. What is in the files is read back by other libraries:
// tests/apps/export_test.cpp.
#include "taut/io/sequence_writer.h"

#include <gtest/gtest.h>

#include <set>

#include "io/temporary_folder.h"
#include "taut/base/error.h"
#include "taut/io/obj.h"
#include "taut/io/pc2.h"
#include "taut/io/ply.h"

namespace taut::test {
namespace {

namespace fs = std::filesystem;

// A triangle that moves and one that does not, with names that no file should have.
std::vector<SequenceObject> two_objects() {
  SequenceObject cloth{.name = "a/b \"c\"",
                       .triangles = {{0, 1, 2}},
                       .texcoords = {{0, 0}, {1, 0}, {0.25, 1}},
                       .points = 3,
                       .stem = {}};
  SequenceObject solid{.name = "a b c ",
                       .triangles = {{0, 1, 2}},
                       .texcoords = {},
                       .points = 3,
                       .moves = false,
                       .is_cloth = false,
                       .stem = {}};
  return {cloth, solid};
}

std::vector<ObjectFrame> frame_at(int number) {
  const std::vector<Vec3> points{{0.1 * number, 0, 0}, {1, 0.3, 0}, {0, 1, -2}};
  return {{points, {{"stretch", 1, {0, 1, 2}}}}, {{{5, 5, 5}, {6, 5, 5}, {5, 6, 5}}, {}}};
}

std::set<std::string> files_in(const fs::path& folder) {
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder))
    names.insert(entry.path().filename().string());
  return names;
}

std::unique_ptr<SequenceWriter> writer_into(const fs::path& folder, const std::string& format,
                                            int first = 0, int frames = 3) {
  return make_sequence_writer(sequence_format(format),
                              {.folder = folder,
                               .title = "Two \"objects\"\n",
                               .first_frame = first,
                               .frames = frames,
                               .frame_interval = 0.5},
                              two_objects());
}

void write_frames(SequenceWriter& writer, int first = 0) {
  for (int k = first; k < first + 3; ++k) writer.add_frame(k, frame_at(k));
}

TEST(SequenceWriter, EveryFormatMakesItsFilesAndNothingElse) {
  const std::map<std::string, std::set<std::string>> expected{
      {"usd", {"sequence.usda"}},
      {"gltf", {"sequence.glb"}},
      {"obj", {"a_b__c__000004.obj", "a_b__c__000005.obj", "a_b__c__000006.obj", "a_b_c_.obj"}},
      {"ply", {"a_b__c__000004.ply", "a_b__c__000005.ply", "a_b__c__000006.ply", "a_b_c_.ply"}},
      {"vtk",
       {"a_b__c__000004.vtp", "a_b__c__000005.vtp", "a_b__c__000006.vtp", "a_b_c_.vtp",
        "sequence.pvd"}},
      {"pc2", {"a_b__c_.obj", "a_b__c_.pc2", "a_b_c_.obj"}},
      {"mdd", {"a_b__c_.obj", "a_b__c_.mdd", "a_b_c_.obj"}}};
  EXPECT_EQ(expected.size(), sequence_formats().size());
  for (const auto& [format, files] : expected) {
    const TemporaryFolder folder;
    const auto writer = writer_into(folder / "out", format, 4);
    write_frames(*writer, 4);
    writer->finish();
    EXPECT_EQ(files_in(folder / "out"), files) << format;
    EXPECT_EQ(writer->frames_added(), 3);
  }
}

TEST(SequenceWriter, BeforeFinishNoHalfFileIsSeen) {
  for (const SequenceFormat& format : sequence_formats()) {
    const TemporaryFolder folder;
    {
      const auto writer = writer_into(folder / "out", format.name);
      write_frames(*writer);
    }
    if (!fs::exists(folder / "out")) continue;
    for (const std::string& name : files_in(folder / "out")) {
      const std::string extension = fs::path(name).extension().string();
      EXPECT_TRUE(extension == ".obj" || extension == ".ply" || extension == ".vtp")
          << format.name << " left " << name;
    }
  }
}

TEST(SequenceWriter, NamesThatBecomeAlikeAreNumbered) {
  const TemporaryFolder folder;
  std::vector<SequenceObject> objects = two_objects();
  objects[0].name = "1 ä";
  objects[1].name = "1*:";
  const auto writer = make_sequence_writer(sequence_format("obj"),
                                           {.folder = folder / "out", .title = {}}, objects);
  EXPECT_EQ(writer->objects()[0].stem, "_1___");
  EXPECT_EQ(writer->objects()[1].stem, "_1__");
  objects[1].name = objects[0].name;
  EXPECT_EQ(
      make_sequence_writer(sequence_format("obj"), {.folder = folder / "out", .title = {}}, objects)
          ->objects()[1]
          .stem,
      "_1____2");
}

TEST(SequenceWriter, MeshFilesReadBack) {
  const TemporaryFolder folder;
  for (const char* format : {"obj", "ply"}) {
    const auto writer = writer_into(folder / "out", format);
    write_frames(*writer);
    writer->finish();
  }
  const TriangleMesh obj = read_obj(folder / "out/a_b__c__000002.obj"),
                     ply = read_ply(folder / "out/a_b__c__000002.ply");
  EXPECT_EQ(obj.positions[1], Vec3(1, 0.3, 0));  // the shortest decimal of the float
  EXPECT_EQ(obj.texcoords, two_objects()[0].texcoords);
  EXPECT_EQ(ply.positions[0], Vec3(0.2F, 0, 0));
  EXPECT_EQ(ply.triangles, two_objects()[0].triangles);
  EXPECT_EQ(read_ply(folder / "out/a_b_c_.ply").positions[1], Vec3(6, 5, 5));
}

TEST(SequenceWriter, PointCacheReadsBack) {
  const TemporaryFolder folder;
  const auto writer = writer_into(folder / "out", "pc2", 4);
  write_frames(*writer, 4);
  writer->finish();
  const PointCache cache = read_pc2(folder / "out/a_b__c_.pc2");
  EXPECT_EQ(cache.start_frame, 4.0);
  ASSERT_EQ(cache.samples(), 3);
  EXPECT_EQ(cache.sample(2)[0], Vec3(0.6F, 0, 0));
  EXPECT_EQ(cache.sample(2)[2], Vec3(0, 1, -2));
}

TEST(SequenceWriter, AGltfFileThatNoProgramOpensIsRefusedBeforeItIsWritten) {
  const TemporaryFolder folder;
  std::vector<SequenceObject> objects = two_objects();
  objects[0].points = 100'000;
  const SequenceOptions options{.folder = folder / "out", .title = {}, .frames = 500};
  try {
    make_sequence_writer(sequence_format("gltf"), options, objects);
    FAIL() << "no InputError";
  } catch (const InputError& error) {
    const std::string message = error.what();
    for (const char* part :
         {"sequence.glb: would have 57", " MiB for 500 frames", "--frames FIRST:LAST:STEP", "usd"})
      EXPECT_NE(message.find(part), std::string::npos) << message;
  }
  EXPECT_FALSE(fs::exists(folder / "out"));
}

TEST(SequenceWriter, WhatCannotBeWrittenIsSaid) {
  for (const SequenceFormat& format : sequence_formats()) {
    const TemporaryFolder folder;
    folder.file("file", "");
    try {
      const auto writer = writer_into(folder / "file/out", format.name);
      write_frames(*writer);
      writer->finish();
      ADD_FAILURE() << format.name;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("cannot be written: "), std::string::npos)
          << error.what();
    }
  }
}

TEST(SequenceWriter, AnUnknownFormatIsRefusedWithThoseThereAre) {
  try {
    sequence_format("abc");
    FAIL() << "no InputError";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("usd, obj, ply, pc2, mdd, vtk, gltf"),
              std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace taut::test
