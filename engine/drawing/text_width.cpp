// Advance widths of DejaVu Sans, measured from the font's own tables by FreeType: the face that Debian's "sans" is, and
// the widest of those that an SVG of ours names, so that what fits by these fits in any of them.
#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "gdtslam/drawing/canvas.hpp"
#include "letters.hpp"

namespace gdtslam {
namespace {

// In 1/1000 of the letter size, code points from the first of a block on.
constexpr std::array<std::uint16_t, 95> kRegularAscii{
    318, 401, 460, 838, 636, 950, 780, 275, 390, 390, 500, 838, 318, 361,  318, 337, 636, 636, 636,
    636, 636, 636, 636, 636, 636, 636, 337, 337, 838, 838, 838, 531, 1000, 684, 686, 698, 770, 632,
    575, 775, 752, 295, 295, 656, 557, 863, 748, 787, 603, 787, 695, 635,  611, 732, 684, 989, 685,
    611, 685, 390, 337, 390, 838, 500, 500, 613, 635, 550, 635, 615, 352,  635, 634, 278, 278, 579,
    278, 974, 634, 612, 635, 635, 411, 521, 392, 634, 592, 818, 592, 592,  525, 636, 337, 636, 838};
constexpr std::array<std::uint16_t, 96> kRegularLatin{
    318, 401, 636, 636, 636, 636, 337, 500, 500, 1000, 471, 612, 838, 361, 1000, 500, 500, 838, 401, 401,
    500, 636, 636, 318, 500, 401, 471, 612, 969, 969,  969, 531, 684, 684, 684,  684, 684, 684, 974, 698,
    632, 632, 632, 632, 295, 295, 295, 295, 775, 748,  787, 787, 787, 787, 787,  838, 787, 732, 732, 732,
    732, 611, 605, 630, 613, 613, 613, 613, 613, 613,  982, 550, 615, 615, 615,  615, 278, 278, 278, 278,
    612, 634, 612, 612, 612, 612, 612, 838, 612, 634,  634, 634, 634, 592, 635,  592};
constexpr std::array<std::uint16_t, 57> kRegularGreek{
    684, 686, 557, 684, 632, 685, 752, 787, 295, 656, 684, 863, 748, 632, 787, 752, 603, 600, 632,
    611, 611, 787, 685, 787, 764, 295, 611, 659, 541, 634, 338, 579, 659, 638, 592, 612, 541, 544,
    634, 612, 338, 589, 592, 636, 559, 558, 612, 602, 635, 587, 634, 602, 579, 660, 578, 660, 837};
constexpr std::array<std::uint16_t, 23> kRegularPunctuation{361, 361, 636, 500, 1000, 1000, 500, 500,
                                                            318, 318, 318, 318, 518,  518,  518, 518,
                                                            500, 500, 590, 590, 334,  667,  1000};
constexpr std::array<std::uint16_t, 95> kBoldAscii{
    348, 456,  521, 838, 696, 1002, 872, 306, 457, 457, 523, 838, 380, 415,  380, 365, 696, 696,  696,
    696, 696,  696, 696, 696, 696,  696, 400, 400, 838, 838, 838, 580, 1000, 774, 762, 734, 830,  683,
    683, 821,  837, 372, 372, 775,  637, 995, 837, 850, 733, 850, 770, 720,  682, 812, 774, 1103, 771,
    724, 725,  457, 365, 457, 838,  500, 500, 675, 716, 593, 716, 678, 435,  716, 712, 343, 343,  665,
    343, 1042, 712, 687, 716, 716,  493, 595, 478, 712, 652, 924, 645, 652,  582, 712, 365, 712,  838};
constexpr std::array<std::uint16_t, 96> kBoldLatin{
    348, 456, 696, 696, 636, 696, 365, 500, 500,  1000, 564,  646, 838, 415, 1000, 500, 500, 838, 438,  438,
    500, 736, 636, 380, 500, 438, 564, 646, 1035, 1035, 1035, 580, 774, 774, 774,  774, 774, 774, 1085, 734,
    683, 683, 683, 683, 372, 372, 372, 372, 838,  837,  850,  850, 850, 850, 850,  838, 850, 812, 812,  812,
    812, 724, 738, 719, 675, 675, 675, 675, 675,  675,  1048, 593, 678, 678, 678,  678, 343, 343, 343,  343,
    687, 712, 687, 687, 687, 687, 687, 838, 687,  712,  712,  712, 712, 652, 716,  652};
constexpr std::array<std::uint16_t, 57> kBoldGreek{
    774, 762, 637, 774, 683, 725, 837, 850, 372, 775, 774, 995, 837, 632, 850, 837, 733, 600, 683,
    682, 724, 850, 771, 850, 850, 372, 724, 687, 557, 712, 390, 675, 687, 716, 681, 687, 557, 591,
    712, 687, 390, 710, 633, 736, 681, 591, 687, 791, 716, 593, 779, 638, 675, 782, 645, 794, 869};
constexpr std::array<std::uint16_t, 23> kBoldPunctuation{415, 415, 696, 500, 1000, 1000, 500, 500, 380, 380, 380, 380,
                                                         657, 657, 657, 657, 500,  500,  639, 639, 333, 667, 1000};

struct Sign {
  char32_t code;
  std::uint16_t regular;
  std::uint16_t bold;
};
constexpr std::array kSigns{Sign{0x2030, 1342, 1440}, Sign{0x2032, 227, 264}, Sign{0x2033, 374, 447},
                            Sign{0x207b, 528, 528},   Sign{0x2080, 401, 438}, Sign{0x2081, 401, 438},
                            Sign{0x2082, 401, 438},   Sign{0x2083, 401, 438}, Sign{0x2190, 838, 838},
                            Sign{0x2191, 838, 838},   Sign{0x2192, 838, 838}, Sign{0x2193, 838, 838},
                            Sign{0x2211, 674, 718},   Sign{0x2212, 838, 838}, Sign{0x221a, 637, 667},
                            Sign{0x221e, 833, 833},   Sign{0x2248, 838, 838}, Sign{0x2260, 838, 838},
                            Sign{0x2264, 838, 838},   Sign{0x2265, 838, 838}, Sign{0x2713, 838, 838}};

/// Of letters beyond the tables: about an em for what East Asia writes, else a wide Latin letter.
constexpr std::uint16_t kWide = 1000;
constexpr std::uint16_t kOther = 640;

template <std::size_t N>
constexpr bool covers(const std::array<std::uint16_t, N>&, char32_t first, char32_t code) {
  return code >= first && code < first + N;
}

std::uint16_t advance_of(char32_t code, bool is_bold) {
  if (covers(kRegularAscii, 0x20, code)) return (is_bold ? kBoldAscii : kRegularAscii).at(code - 0x20);
  if (covers(kRegularLatin, 0xa0, code)) return (is_bold ? kBoldLatin : kRegularLatin).at(code - 0xa0);
  if (covers(kRegularGreek, 0x391, code)) return (is_bold ? kBoldGreek : kRegularGreek).at(code - 0x391);
  if (covers(kRegularPunctuation, 0x2010, code)) {
    return (is_bold ? kBoldPunctuation : kRegularPunctuation).at(code - 0x2010);
  }
  const auto* const sign =
      std::find_if(kSigns.begin(), kSigns.end(), [code](const Sign& candidate) { return candidate.code == code; });
  if (sign != kSigns.end()) return is_bold ? sign->bold : sign->regular;
  return code >= 0x2e80 ? kWide : kOther;
}

}  // namespace

double text_width(std::string_view words, double size, bool is_bold) {
  double thousandths = 0.0;
  for (std::size_t at = 0; at < words.size();) thousandths += advance_of(next_letter(words, at).code, is_bold);
  return thousandths * size / 1000.0;
}

std::string shortened(const std::string& words, double size, double room, bool is_bold) {
  if (text_width(words, size, is_bold) <= room) return words;
  const std::string dots = "\xE2\x80\xA6";
  std::string cut = words;
  while (!cut.empty() && text_width(cut + dots, size, is_bold) > room) {
    // A letter may take several bytes: those that continue it go with it.
    while (cut.size() > 1 && (static_cast<unsigned char>(cut.back()) & 0xC0U) == 0x80U) cut.pop_back();
    cut.pop_back();
  }
  return cut + dots;
}

std::string shortened_within(const std::string& words, double size, double room, std::size_t kept) {
  if (text_width(words, size) <= room) return words;
  std::string tail = words.substr(words.size() - std::min(kept, words.size()));
  const std::string name = words.substr(0, words.size() - tail.size());
  if (text_width(tail, size) > room * 2.0 / 3.0) tail.clear();
  std::vector<std::string_view> letters;
  for (std::size_t at = 0; at < name.size();) letters.push_back(next_letter(name, at).bytes);
  const auto with_letters = [&](std::size_t count) {
    std::string text;
    for (std::size_t k = 0; k < (count + 1) / 2; ++k) text += letters[k];
    if (count < letters.size()) text += "\xE2\x80\xA6";
    for (std::size_t k = letters.size() - count / 2; k < letters.size(); ++k) text += letters[k];
    return text + tail;
  };
  std::size_t fits = 0;  // so many do, or none can
  std::size_t least_beyond = letters.size() + 1;
  while (fits + 1 < least_beyond) {
    const std::size_t count = fits + (least_beyond - fits) / 2;
    (text_width(with_letters(count), size) <= room ? fits : least_beyond) = count;
  }
  return with_letters(fits);
}

}  // namespace gdtslam
