#include <array>

#include "mien/base/hash.h"
#include "mien/corpus/text.h"

namespace mien {
namespace {

constexpr std::array<std::string_view, 80> kSentences = {
    "Peter bought a big map before the boat came back.",
    "My mother made warm bread for every member of the team.",
    "The five brave wolves vanished over the frozen river.",
    "We would wash the white window while we waited for rain.",
    "She saw a shiny shell on the shallow shore this season.",
    "Charlie chose cheap cherries from the church orchard.",
    "Judge George enjoyed orange juice and ginger jam.",
    "Those three brothers thought that the weather was rather rough.",
    "The cook took a good look at the wooden hook.",
    "Who knew the blue moon could move you so soon?",
    "Our loud brown cow found a town house and bowed down.",
    "The noisy boy joined a royal voyage with his toys.",
    "He hurried home, hoping his old horse had behaved.",
    "Quick queens quietly question the quality of quilts.",
    "A lazy zebra was dozing in the hazy zoo.",
    "Yes, the young yak yelled at the yellow yacht yesterday.",
    "Bob's baby blew bubbles and popped a purple balloon.",
    "Put the paper cup upon the upper step, please.",
    "Mammals swim, but most mammoths simply marched.",
    "Five fat fish fought for half of a muffin.",
    "Eve believes heavy gloves save very few lives.",
    "Keep each green leaf clean and feed these three bees.",
    "Sit still a bit and listen to this thin violin.",
    "Ten men sent seven letters then went to rest.",
    "That fat black cat sat back and had a nap.",
    "Father parked the large car far from the calm harbor.",
    "Bought, taught, caught, and brought are awful verbs to spell.",
    "Only go slowly over cold snow, no matter who phones.",
    "Under the sun, some young lovers run from trouble.",
    "Birds were first to learn the early worm's circle.",
    "Near here, clear beer appears every year.",
    "Where there is fair air, a bear will share a pear.",
    "Please call me back at half past eleven.",
    "I never said that you should leave the room.",
    "What on earth are you doing up there?",
    "That was the funniest thing that I ever heard!",
    "Could you possibly bring me a glass of water?",
    "The results of the measurement surprised everyone in the laboratory.",
    "Statistics show that traffic peaks just before six o'clock.",
    "Nobody expected the orchestra to stop in the middle of the waltz.",
    "A thick fog swallowed the bridge, and then the whole valley.",
    "Most of the time, silence is the strongest answer.",
    "Turn left at the bakery, then walk toward the fountain.",
    "Eight tall ships sailed past the gray lighthouse.",
    "My uncle, a modest farmer, owns twelve beehives and a pump.",
    "Give the package to the woman with the umbrella.",
    "Why would a wizard whisper without a wand?",
    "The brown fox jumped, rolled, and slept by the pond.",
    "If it snows tomorrow, we will postpone the picnic.",
    "Both of them promised to come back before midnight.",
    "Deep beneath the palace, a small pump was humming.",
    "Nine hundred and forty seven bottles were empty.",
    "The museum of maps opens from Monday through Thursday.",
    "I beg your pardon, but this seat has been taken.",
    "Oh no, the bus has already left without us.",
    "Mix the butter with sugar, then add the beaten egg.",
    "Look, the moon is rising above the mountains!",
    "We met at a small cafe near the old theater.",
    "His voice was so soft that nobody heard the warning.",
    "A good memory is often better than a sharp pencil.",
    "Open the window and let the fresh air in.",
    "Our plumber fixed the pipe, the pump, and the tap.",
    "The judge allowed the witness to leave the court.",
    "Music makes people move in surprising ways.",
    "Purple flowers bloom beside the broken wall.",
    "Can you imagine a world without a single mirror?",
    "The oyster farm employs forty fishermen in winter.",
    "Every morning he polishes the brass bell at the gate.",
    "She laughed, clapped, and asked for one more song.",
    "They measured the garage and treasured the vision.",
    "Bring both boys to the ballpark before breakfast.",
    "Sharp scissors slip easily through silk.",
    "Thank you so much for everything you have done.",
    "Wait for me by the front door of the bank.",
    "Our mobile phones buzz whenever a message appears.",
    "Pink paint dripped from the top of the ladder.",
    "The choir hummed a calm and solemn melody.",
    "How many pounds of plums would you like?",
    "This old wooden puzzle has over a thousand pieces.",
    "Stop! Do not move, there is a wasp on your arm."};

}  // namespace

std::span<const std::string_view, 80> fixed_sentences() { return kSentences; }

TextSplit split_of_text(std::string_view text) {
  const std::uint64_t percent = hash64(text) % 100;
  return percent < 90 ? TextSplit::train : percent < 95 ? TextSplit::valid : TextSplit::test;
}

}  // namespace mien
