// Which room of server/ may include which: the folders are the way of a request, and no arrow runs back.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

namespace least::server {
namespace {

struct Room {
  std::string_view folder;
  std::vector<std::string_view> may_include;  // beginnings of paths
};

const std::vector<Room> rooms{
    {"server/shared/", {"server/shared/", "core/describe.hpp"}},
    // The transport knows nothing of simulations.
    {"server/http/",
     {"server/http/", "server/shared/answer.hpp", "server/shared/http_status.hpp", "server/shared/result.hpp"}},
    {"server/decode/", {"server/decode/", "server/shared/", "core/"}},
    {"server/encode/", {"server/encode/", "server/shared/", "core/"}},
    {"server/", {"server/", "core/"}},  // what joins them
};

// What a file of ours includes of ours.
std::vector<std::string> includes(const std::filesystem::path& file) {
  constexpr std::string_view mark = "#include \"";
  std::vector<std::string> paths;
  std::ifstream text(file);
  for (std::string line; std::getline(text, line);) {
    if (!line.starts_with(mark)) continue;
    paths.push_back(line.substr(mark.size(), line.find('"', mark.size()) - mark.size()));
  }
  return paths;
}

TEST(Rooms, IncludeOnlyWhatTheyMay) {
  const std::filesystem::path root = LEAST_SOURCE_DIR;
  std::vector<std::size_t> files(rooms.size());
  for (const auto& entry : std::filesystem::recursive_directory_iterator(root / "server")) {
    if (entry.path().extension() != ".cpp" && entry.path().extension() != ".hpp") continue;
    const std::string file = std::filesystem::relative(entry.path(), root).generic_string();
    const auto room =
        std::find_if(rooms.begin(), rooms.end(), [&](const Room& r) { return file.starts_with(r.folder); });
    ++files[static_cast<std::size_t>(room - rooms.begin())];
    for (const std::string& path : includes(entry.path())) {
      EXPECT_TRUE(std::any_of(room->may_include.begin(), room->may_include.end(),
                              [&](std::string_view beginning) { return path.starts_with(beginning); }))
          << file << " includes " << path;
    }
  }
  for (std::size_t i = 0; i < rooms.size(); ++i) EXPECT_GT(files[i], 0u) << rooms[i].folder;
}

}  // namespace
}  // namespace least::server
