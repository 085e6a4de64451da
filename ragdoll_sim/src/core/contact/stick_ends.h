// Which contacts with one obstacle are a stick's, and which are those of the particles at its ends.
#pragma once

#include <vector>

#include "core/contact/contact.h"

namespace ragdoll {

/// Takes out of the springs of particles what the sticks have of them that press between their
/// ends: of the contacts from `begin` on, all with one obstacle.
void shareSprings(const Model& model, const Obstacle& obstacle, const Ragdoll& ragdoll,
                  std::size_t begin, std::vector<Contact>& contacts);

/// On what is round a stick has springs at its deepest place and at its shallower end, so that none
/// comes or goes as the place moves onto the deeper end. Takes that end's out, of the contacts from
/// `begin` on, all with one obstacle.
void dropDeeperEnds(std::size_t begin, std::vector<Contact>& contacts);

/// Takes the ends out that are the sticks' (Contact::has_end), of the contacts from `begin` on, all
/// with one obstacle. They come near as the place runs to them, and would be hit just before it is
/// there.
void dropEndsOfSticks(std::size_t begin, std::vector<Contact>& contacts);

}  // namespace ragdoll
