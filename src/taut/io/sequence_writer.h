#pragma once
// Moving meshes as files of other programs: the seam behind `taut export`.
//
//   object   a cloth or a solid: triangles, texture coordinates and number of points never change,
//            only the points move
//   frame    points and fields of every object at one time; in the order of the objects
//   stem     an object's name in files and inside them: letters, digits and _, no two alike (set by
//            make_sequence_writer); where the caller has chosen a file name and the format writes
//            several, the names of these begin with it
//
// A format is a class derived from SequenceWriter in a source of its own, a line in the list of
// sequence_formats.cpp with its declaration in sequence_formats.h, and a test. Coordinates arrive
// in the units and axes they shall have in the file; values are rounded to float32. Every file is
// whole or absent: it appears under its name when it is complete, some formats' files only in
// finish(). A writer destroyed before finish() leaves no half file. Throws InputError naming the
// file when it cannot be written.

#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "taut/base/types.h"
#include "taut/mesh/triangle_mesh.h"

namespace taut {

struct SequenceObject {
  std::string name;
  std::vector<Triangle> triangles;
  std::vector<Vec2> texcoords;  // empty or one a point
  Index points = 0;
  bool moves = true;  // false: the first frame's points hold for all
  bool is_cloth = true;
  std::string stem;
};

struct PointField {
  std::string name;
  int components = 1;
  std::vector<double> values;  // `components` a point
};

struct ObjectFrame {
  std::vector<Vec3> points;
  std::vector<PointField> fields;
};

enum class UpAxis { y, z };

struct SequenceOptions {
  std::filesystem::path folder;
  std::string file_name = {};  // with its ending; empty: the format's usual names
  std::string title;
  int first_frame = 0;
  int frames = 1;               // that will come at most, for formats that are limited in size
  int frame_stride = 1;         // from one frame that is added to the next
  double frame_interval = 0.0;  // s from one frame number to the next
  UpAxis up = UpAxis::z;
  double metres_per_unit = 1.0;

  // The file that holds everything, or lists all others.
  std::filesystem::path main_file(const char* usual_name) const {
    return folder / (file_name.empty() ? usual_name : file_name);
  }
};

class SequenceWriter {
 public:
  SequenceWriter(SequenceOptions options, std::vector<SequenceObject> objects)
      : options_(std::move(options)), objects_(std::move(objects)) {}
  virtual ~SequenceWriter() = default;
  SequenceWriter(const SequenceWriter&) = delete;
  SequenceWriter& operator=(const SequenceWriter&) = delete;

  // `number`: of the frame, growing from call to call; its time is number * frame_interval. One
  // entry of `frame` an object.
  void add_frame(int number, std::span<const ObjectFrame> frame);
  // At least one frame must have been added.
  virtual void finish() = 0;

  const SequenceOptions& options() const { return options_; }
  std::span<const SequenceObject> objects() const { return objects_; }
  int frames_added() const { return frames_added_; }

 protected:
  virtual void write_frame(int number, std::span<const ObjectFrame> frame) = 0;
  double time_of(int number) const { return number * options_.frame_interval; }
  std::filesystem::path file(const std::string& name) const { return options_.folder / name; }
  bool is_first() const { return frames_added_ == 0; }  // within write_frame

 private:
  SequenceOptions options_;
  std::vector<SequenceObject> objects_;
  int frames_added_ = 0;
};

struct SequenceFormat {
  const char* name;
  const char* description;  // what files it makes
  const char* endings;      // that a chosen file name may have: ".usda .usd"
  bool is_one_file;         // for all frames and objects
  UpAxis usual_up;
  std::unique_ptr<SequenceWriter> (*make)(SequenceOptions options,
                                          std::vector<SequenceObject> objects);
};

std::span<const SequenceFormat> sequence_formats();
// Throws InputError for a name that is none of sequence_formats().
const SequenceFormat& sequence_format(const std::string& name);
// The format whose files end as this name does; null where none does. Throws InputError, saying
// what to give instead, for a kind of file that only sisters of are written (.usdc).
const SequenceFormat* sequence_format_of(const std::filesystem::path& file_name);
std::unique_ptr<SequenceWriter> make_sequence_writer(const SequenceFormat& format,
                                                     SequenceOptions options,
                                                     std::vector<SequenceObject> objects);

}  // namespace taut
