// What rk's motion from event to event is bounded by (docs/equations.md#event-driven-rk). Not
// tuned: below all errors that are asked for, above rounding; caps of loops that converge.
#pragma once

namespace ragdoll {

// --- Pieces and events.
constexpr double kGrowth = 3;      ///< of a piece over the one before, until the next event
constexpr int kMostPieces = 6000;  ///< of one step, those that were too long among them
/// Within a tolerance: so many, and that share of the parts that shake would take at the most.
constexpr int kFewPieces = 10;
constexpr double kPiecesOfParts = 0.05;
/// [m/s] By the embedded formula. A slip that begins or ends asks for pieces as short as the time
/// in which it changes: friction follows its direction.
constexpr double kPieceError = 1e-11;
constexpr int kOrderOfPiece = 5;  ///< of that error
/// Of a tolerance's spare error: what one piece may take of it.
constexpr double kOfSpare = 0.125;
constexpr double kPieceAim = 0.8;       ///< of the longest piece that keeps it
constexpr double kHalfPiece = 0.5;      ///< of one that did not, at most
constexpr int kMostSolutions = 100;     ///< of equalities, until the directions of slips are found
constexpr double kSpringPhase = 0.125;  ///< [rad] of what swings on a spring, in a piece
constexpr double kMoment = 1e-7;  ///< [s] after which it is looked at whether a spring presses
constexpr int kMostLists = 4;     ///< of what a step may meet, each of a motion that went farther
constexpr int kMaxEvents = 60;    ///< in one step; more crowd (Zeno, chatter): shake's steps
constexpr int kMostModeRows =
    96;  ///< of closed contacts and limits; what lies with more is at rest
/// [m] Along a motion, for second derivatives by differences of fourth order: 1e-12 of their size.
constexpr double kDifference = 3e-4;
constexpr double kFlatCurvature =
    1e-5;                           ///< [m] of a gap along a stick: flatter has no nearest place
constexpr double kFlatPair = 1e-8;  ///< [m] the same between two sticks: they lie along each other
constexpr double kBeyondEnd = 1;    ///< of a stick: a place is looked for so far beyond its end
constexpr int kPlaceRefinements = 4;      ///< Newton iterations to the nearest places of two sticks
constexpr double kReach = 3;              ///< of the present motion: what else may be met in a step
constexpr double kClosedGap = 1e-9;       ///< [m], [rad] what an event leaves of a gap
constexpr double kGapNoise = 1e-11;       ///< [m], [rad] of a gap that is closed
constexpr double kOpened = 1e-10;         ///< [m], [rad] what was open by more closes at zero
constexpr double kStill = 1e-8;           ///< [m/s] of a slip that has ended
constexpr double kImpendingStill = 2e-8;  ///< [m/s] what slips faster is not impending
constexpr double kBarelyMoves = 1e-9;     ///< [m/s] what slips slower keeps its direction
constexpr double kLeaving = 1e-9;         ///< [m/s], [rad/s] what opens faster does not rest
constexpr int kSpinRounds = 4;            ///< until what holds bodies is what presses on them
constexpr double kRestApproach = 1e-5;    ///< [m/s] slower does not bounce: 5e-12 m high
constexpr double kNoForce = 1e-9;         ///< of the weight and of what presses
constexpr double kLeastOfWeight = 1e-3;   ///< what presses with less is measured by the weight
constexpr double kHeld = 4e-9;            ///< of the same: what an event leaves of the cone
constexpr double kOnCone = 1e-9;          ///< of mu f_n: nearer to it is on it
constexpr double kNoAnswer = 1e-12;       ///< [1/kg] of a row that cannot move
constexpr double kDependent = 1e-11;      ///< of rows scaled to a unit diagonal
constexpr double kModeContradiction = 1e-7;   ///< of what is asked for, that equalities may leave
constexpr double kContradictionLeft = 1e-13;  ///< [m/s^2], [rad/s^2] the same where nothing is
constexpr double kSameDirection = 1e-13;  ///< sine between slip and the motion that it begins with
constexpr double kNearlySameDirection = 1e-9;  ///< where rounding is larger
constexpr int kAlignments = 15;                ///< Newton iterations to that
constexpr double kSlipTurn = 1e-6;             ///< [rad] for its derivatives
constexpr double kMostTurn = 0.3;              ///< [rad] of one iteration
constexpr double kTurnsAtOnce = 0.01;   ///< a slip is slow that turns within that share of a piece,
constexpr double kSmallLag = 3e-5;      ///< [rad] of its direction behind: its square is the error,
constexpr double kOffSlow = 1e-10;      ///< [m/s] across that direction
constexpr double kSlowAligned = 1e-12;  ///< [rad]
constexpr double kSlowMoment = 1e-6;    ///< [s] for its derivative
constexpr int kSlowRounds = 4;          ///< until those that are left are on the manifold
constexpr int kMostSlowSlips = 16;      ///< more are followed as any other
constexpr double kSlowShare = 0.01;     ///< of a tolerance, across it
constexpr double kGivesWay = 1e-8;      ///< of rows scaled to a unit diagonal, by Newton's method
constexpr double kSoftest = 1e-2;       ///< the same where it has to begin further away
constexpr double kSofter = 10;          ///< from there on, in turn
constexpr int kNewtonSteps = 60;
constexpr int kNewtonHalvings = 8;        ///< of a step,
constexpr double kNewtonGain = 1e-3;      ///< until it takes that share of itself off the error
constexpr double kNewtonSettled = 1e-11;  ///< error, of all forces
constexpr double kNoRate =
    1e-6;  ///< of what a force does alone: slower does not slip: it is impending
constexpr double kMostLean = 0.01;    ///< of the cone: force across it of what others hold
constexpr int kModeChanges = 60;      ///< until equalities and inequalities agree
constexpr int kModeProjections = 8;   ///< onto sticks and rows in turn; 1 or 2 are usual
constexpr double kProjected = 1e-13;  ///< [m], [rad] to which that converges
constexpr int kEventSamples = 4;      ///< in a piece, between which event functions are looked at
/// Of an event's time, by motions that end there. What takes more touches and does not pass, as the
/// end of a stick where what it touches runs there: a shorter piece tells.
constexpr int kEventRefinements = 12;
constexpr double kPlaceNoise = 1e-12;  ///< [m], and of a stick's length
constexpr double kSlipNoise = 1e-12;   ///< [m/s]
constexpr int kZeroSearches = 40;      ///< for an event within a sample: a cap
constexpr double kZeroShare = 1e-9;    ///< of the piece; motions that end there do the rest
constexpr double kSlopeShare = 1e-3;   ///< of the piece, over which an event function is straight
constexpr double kEventNear = 1e-10;   ///< [s] and to which it has to
/// [m], [rad] What opens by less before it closes again has not opened: two rows that open each
/// other in turn would do so a thousand times.
constexpr double kChatterGap = 1e-9;
constexpr int kShorterPieces = 10;       ///< until an event is located in one
constexpr double kShorterPiece = 0.125;  ///< of the one before
constexpr double kEarly = 0.02;          ///< of a piece: an event before that is looked for again
constexpr double kMostCorrection = 0.1;  ///< of a piece, of an event's time by one motion
constexpr double kEventTime = 1e-13;     ///< [s] to which that converges

}  // namespace ragdoll
