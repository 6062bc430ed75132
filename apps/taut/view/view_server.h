#pragma once
// Shows a results folder to a browser on this machine, read-only.
//
//   http://127.0.0.1:PORT/KEY/              the page
//   http://127.0.0.1:PORT/KEY/api/NAME      what it asks for:
//     state                                 RunStateReader::read, JSON
//     scene                                 scene_json, JSON
//     triangles, uv, springs, rest_lengths  of the .npy file, little-endian int32 or float32
//     frames?first=F&count=N                frames F ... F+N-1, float32 (nodes, 3) each; fewer
//                                           where that is over 64 MiB, or not there yet
//     stats?from=BYTE                       stats.csv from there to the end of its last whole row;
//                                           header Taut-Stats names the file (RunStateReader)
//   An error is a JSON object {"error": "what and why"} with status 400, 404 or 500.

#include <memory>
#include <string>

#include "view/page_files.h"
#include "view/result_files.h"

namespace taut::app {

// KEY is random: other users of this machine, who can reach the port, do not know it. Only
// 127.0.0.1 is listened to. Refused: methods other than GET and HEAD; a Host that is not this
// server's (a page of another site whose name was made to point here); every path that is not one
// of the above, or of a file of the page. The page may load nothing from elsewhere, nor be framed
// (Content-Security-Policy).
class ViewServer {
 public:
  // port 0: a free one. Throws InputError when the port cannot be had.
  ViewServer(ResultFiles files, PageFiles page, int port);
  ~ViewServer();
  std::string address() const;  // with KEY
  // Serves until stop(), which may be called from another thread.
  void run();
  void stop();

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace taut::app
