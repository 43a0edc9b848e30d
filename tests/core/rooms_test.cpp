// Which folder may include which: the folders follow the way of a request, and no include goes back.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <string>

namespace {

using Names = std::set<std::string>;

/// rooms() returns every folder with those that it may include; a file directly in core/ or server/ is in a folder of
/// that name.
const std::map<std::string, Names>& rooms() {
  static const std::map<std::string, Names> all = [] {
    const Names base{"core/number", "core", "core/tape", "core/text"};
    const auto beside = [](Names names, std::initializer_list<std::string> more) {
      names.insert(more);
      return names;
    };
    const Names run = beside(base, {"core/exact", "core/problems", "core/schemes", "core/text"});
    const Names reference = beside(run, {"core/run"}), study = beside(reference, {"core/reference"});
    const Names catalogue = beside(study, {"core/study", "core/ensemble"}),
                variations = beside(catalogue, {"core/catalogue"}), periodic = beside(variations, {"core/variations"}),
                core = beside(periodic, {"core/periodic"});
    return std::map<std::string, Names>{
        {"core/number", {}},
        {"core/tape", {"core/number"}},
        {"core/text", {"core/number", "core/tape", "core"}},
        {"core", {"core/number"}},
        {"core/exact", base},
        {"core/problems", beside(base, {"core/exact"})},
        {"core/schemes", base},
        {"core/run", run},
        {"core/reference", reference},
        {"core/study", study},
        {"core/ensemble", study},
        {"core/catalogue", catalogue},
        {"core/variations", variations},
        {"core/periodic", periodic},
        {"server/shared", core},
        {"server/http", {"server/shared"}},  // the transport knows nothing of simulations: see below
        {"server/decode", beside(core, {"server/shared"})},
        {"server/encode", beside(core, {"server/shared"})},
        {"server", beside(core, {"server/shared", "server/http", "server/decode", "server/encode"})},
    };
  }();
  return all;
}
/// The files of the shared folder that the transport may include.
const Names for_transport{"server/shared/answer.hpp", "server/shared/http_status.hpp", "server/shared/log.hpp",
                          "server/shared/memory_budget.hpp", "server/shared/result.hpp"};

std::string room_of(const std::filesystem::path& file) {
  const auto part = [&](int i) { return std::next(file.begin(), i)->string(); };
  const auto depth = std::distance(file.begin(), file.end());
  return depth > 2 ? part(0) + "/" + part(1) : part(0);
}

/// includes() returns the files of the project that a file includes.
Names includes(const std::filesystem::path& file) {
  const std::string mark = "#include \"";
  Names paths;
  std::ifstream text(file);
  for (std::string line; std::getline(text, line);)
    if (line.starts_with(mark)) paths.insert(line.substr(mark.size(), line.find('"', mark.size()) - mark.size()));
  return paths;
}

TEST(Rooms, NoArrowRunsBack) {
  const std::filesystem::path root = LEAST_SOURCE_DIR;
  std::map<std::string, int> files;
  for (const char* half : {"core", "server"})
    for (const auto& entry : std::filesystem::recursive_directory_iterator(root / half)) {
      if (entry.path().extension() != ".cpp" && entry.path().extension() != ".hpp") continue;
      const auto file = std::filesystem::relative(entry.path(), root);
      const std::string room = room_of(file);
      ASSERT_TRUE(rooms().contains(room)) << file << " lies in a room that has no place in the order";
      ++files[room];
      for (const std::string& path : includes(entry.path())) {
        if (!path.starts_with("core/") && !path.starts_with("server/")) continue;  // made by the build
        const std::string other = room_of(path);
        EXPECT_TRUE(other == room || rooms().at(room).contains(other)) << file << " includes " << path;
        if (room == "server/http" && other == "server/shared") {
          EXPECT_TRUE(for_transport.contains(path)) << file << " includes " << path;
        }
      }
    }
  for (const auto& [room, arrows] : rooms()) EXPECT_GT(files[room], 0) << room << " is empty";
}

}  // namespace
