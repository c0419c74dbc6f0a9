"""Every threshold by which something is added, exchanged, taken back or told, with where it comes from.

:class:`Rules` are those that a caller may change. The others are constants. Practice logs are the cases
p01-p14 and q01-q14 of another simulator; worlds are the arms of ``python -m benchmarks.worlds``.
"""

from dataclasses import dataclass


@dataclass(frozen=True)
class Rules:
    """Thresholds of the decision.

    Attributes:
        significance: Chance that anything is added to a log without a missing effect: the level of the
            whole family of tests, divided by their number (C. E. Bonferroni, 1936).
        share: Least share of a joint's held-out squared error that an effect has to take off. An effect of
            a fifth of the squared error lowers the error by a tenth, about what a user sees in a torque.
        repeat: Least share of blocks in which it has to help.
        over_noise, over_torque: Least RMS torque that it has to take off its joint's error, over that of
            the noise and of the torque: a fifth of a residual that is nothing is nothing.
        tie: Rivals whose gains differ by fewer standard errors than this are not told apart (two: the
            usual 95 %),
        rival: unless one explains what another leaves with less than this chance of error.
    """

    significance: float = 0.01
    share: float = 0.2
    repeat: float = 0.6
    over_noise: float = 0.3
    over_torque: float = 0.001
    tie: float = 2.0
    rival: float = 0.001


# --- What a candidate is worth -------------------------------------------------------------------------------
# Blocks count among those an effect helps in from this part of the mean gain on.
WEIGHTY = 0.1
# A window is the best of all its lengths and places, and residuals have heavier tails than the normal's: what
# it explains counts by one over this.
SELECTED = 2.0
# Windows beside it that may be events, too, and then are no error that it has to take a share of, nor memory of
# the noise: of four pushes the one found first took 19.8 % of its joint's squared error, and of three what was
# left of another one remembered three times as long as the noise. Of a law that shows in a dozen places most
# are left.
OTHERS = 5
# An event explains at least this many times what a window of its length does on average.
DENSE = 4.0
# An event that takes more than this part of all rows, tails included, leaves too little to fit the rest to.
MOST_TAKEN = 0.5

# --- Competing candidates ------------------------------------------------------------------------------------
# Candidates that say the same thing to this degree (a correlation) compete for one explanation.
OVERLAP = 0.7
# One whose gain is at least this part of the best one's is near it, however certain the difference is.
AS_GOOD = 0.97
# A runner-up that gains so many times what the chosen one gains is told as undecided from it, however uncertain
# itself. Beside 135 additions that are right the others gain at most 1.01 times as much.
GAINS_MORE = 1.1
# A law is a special case of another one that can do all but this part of it.
SPECIAL_CASE = 0.1
# Runners-up that gained at least this part of what the chosen one gained are asked again at the end.
ASKED_AGAIN = 0.6

# --- Structure that no law explains --------------------------------------------------------------------------
# Least share of a joint's held-out squared error to call structure: that of a law, see Rules.share.
STRUCTURE = 0.2
# What a second variable has to add to the share of the first alone to be named.
SECOND_VARIABLE = 0.06
# States are told beside time where they take off at least this part of what a function of time does, and leave
# at most one over it of what that leaves. A function of time follows what states do in slow motion, and the
# other way round: of 201 torques by states on logs of 4 to 24 s of two simulators time was named for 12, with
# the states beside it for 9; of 428 drifts told by time (warm friction, steps, ramps, a load picked up) 25 had
# states beside it, 22 of them on 6 to 8 s. In the place of time they would be wrong more often than right.
TIMED = 0.5
# Chance of structure where there is none, over all variables and pairs.
STRUCTURE_SIGNIFICANCE = 0.01
# A law below the first share of a joint's error stands in for an unknown one where a smooth function of one or
# two variables reaches the second, and so many times the law's own.
SMALL_PART, NEARLY_ALL, TIMES_OWN = 0.45, 0.7, 2.0
# A law is not what is missing where a function of what it is about takes the first share off what it leaves far
# above the noise, and that is beyond the second part of what it took: a cushion told as a spring with a dead
# zone left 20 times the noise, 0.97 of it by its position, a fifth of its torque.
FOLLOWS_OWN, OF_TAKEN = 0.7, 0.05
# Near the noise it is none where what it leaves by its own variables has this part of the RMS that it took:
# drag by the square of the partner's speed, told as a coupling, left 0.42 (0.49 of the rest, p = 1e-6); four
# laws of the right form, or that can take it on, left nothing (p > 0.4). By a p that chance has among all that
# were asked it is none: on a measured arm a power of the speed left 0.65 (p = 2e-4), and without it more.
OF_TAKEN_NEAR = 0.25
# Of a law that may be told several times on one joint, by its orders, this part of the squared error is left at
# least: a detent told as a ripple left 0.29.
OF_SEVERAL = 0.1
# Nor is one that leaves at least the first part of its joint's squared error, far above the noise, where a
# smooth function in its place leaves less than the second part of that: bumps at two places told as a ripple
# left 0.39 to 0.53 and 0.01 to 0.09.
A_THIRD, FAR_LESS = 1.0 / 3.0, 0.25
# Nor is one on a joint that is left beyond the first multiple of its noise, unless it took the second share of
# the squared error: in a world of Pinocchio's dynamics 11 of 12 additions left beyond 8 times the noise with
# more than a fifth of the RMS were false names; the right one was a ripple, of which more orders are found one
# by one: all of a law and a place count together. Between 2 and 4 times, 8 of 15 were right.
LOST, LOST_SHARE = 8.0, 0.96
# Part of a joint's RMS error that two laws may leave which are added at once, each for the other's sake: of
# friction by the load and a drag that hid each other at 3.7 times the noise a sixth was left.
# They are asked for beyond the second number times the noise: of less a quarter is below what any model leaves.
# They are fitted if first order leaves at most the last number times that: no fit of 13 came a third below it.
PAIR_LEAVES, PAIR_ASKED, PAIR_TO_FIRST_ORDER = 0.25, 3.0, 2.0
# An event is none where a function of the motion predicts this share of what its joint lacks without any, and
# takes as much off its windows: a cushion and a torque by the sum of two positions gave 0.97 to 1.0, 0 a push.
BY_STATE = 0.6
# Nor are several of which this share of the time is nearest, by the state of their joint, to another one of
# them, where windows placed at random have as much by no more than this chance. Five contacts that
# were a dashpot of one direction had 0.61, random ones 0.05 and 0.43 at most.
LIKE_STATES, BY_CHANCE = 0.5, 0.01
# Nor is one of a joint alone where the joint comes to the same places again, in other logs at least twice, and
# the first part of its torque is left there in the second part of all these visits: a detent, which a log came
# through once, had it in both of another one's. Who is pushed once has it in none.
AS_MUCH, MOST_VISITS = 0.5, 2.0 / 3.0
# Nor is one whose joints hardly move meanwhile and whose torque is within this multiple of the RMS that their
# other rests are left with: within two standard deviations of what friction does at rest.
LIKE_RESTS = 2.0
# Share of what an order of few periods leaves that may follow what it is about: a magnet told as a ripple left
# 0.2 (p = 1e-4), drags between two angles told as friction by the position 0.16 to 0.62 (p < 0.003).
ONE_PLACE = 0.1

# --- What is left, against the noise -------------------------------------------------------------------------
# A residual within this multiple of the noise is near it. Clean logs of another simulator are left with 0.9
# to 1.35 times their noise (q01-q04 of the practice logs); a soft joint that was missed left 3.3 times.
NEAR = 2.0
# Part of what a spring takes off its joint that has to be left without the noise of positions, more than not:
# of a stiff joint it was -1.1, of soft ones 1.0.
MORE_THAN_NOISE = 0.5
# A joint that moves on another log is beyond what the fitted motion leaves open where it is left with this
# multiple of what is near the noise, and of what the fit's own doubt leaves open. Of 36 logs of another
# simulator that were clean or told right, one was left with 2.0 times that. One that lacked friction by the
# load (2.9), and whose other log was pushed at a frequency of its own (5.1), was "explained".
BEYOND = 2.5
# Structure whose RMS is within this multiple of the noise of its joint is told as part of that noise, which
# holds what is unknown of the motion: on 11 clean worlds it was 0.6 to 0.9 times it where there was any.
MATERIAL = 1.0
# Residuals beyond this multiple of the noise are looked at for two laws in one if they show structure; those
# that are not near it in any case.
LOUD = 1.25
# Friction holds a joint for moments where the rest is left with less than this part of the squared multiple of
# its noise: on 15 joints of another simulator with true stiction 0.01 to 0.40.
STICKS = 0.5
# Rest is lent where it is left with so many times what motion is left with.
REST_STANDS_OUT = 2.0
# A law that acts in motion at this part of what it does where its joint hardly moves, and more, takes this part
# of the share that it takes off all rows off those of motion, else friction holds the joint: false ones took
# 0.12 to 0.2 of it, those of 12 logs that were true, with true stick and slip, 0.8 and more.
ACTS_MOVING, SHOWS_MOVING = 0.5, 1.0 / 3.0
# A model that leaves this share of all torque on unseen time says nothing of the arm: the log, its units or
# its signs are wrong. The worst right fit of a log at hand leaves a quarter (a missing spring, p04).
HOPELESS = 0.8

# --- Whether a refit confirms a candidate --------------------------------------------------------------------
# A linear coefficient beyond so many standard errors is certain: else it stands for something else.
CERTAIN = 2.0
# The same of an addition that no other log shows, and that was the best of a hundred or more: on 134 worlds
# true ones of half to eight times the noise had 3.9 and more, what noise with a memory left 2.2 to 2.4.
CERTAIN_ALONE = 3.0
# What takes this part off the squared error of its joint is told from nothing though none of its numbers is:
# four true springs on levers, confounded with the weight of their links, took 0.99.
TOLD_BY_SHARE = 0.9
# The same of a law that bends: without it its shape is any, and what is left of it in doubt may be only that,
# as with the part of the load that friction follows about an upright axis, where none is static. Two that took
# 0.68 and 0.90 were true; of three that took half or less two were false.
BENT_TOLD_BY_SHARE = 0.65
# A law that takes this share off the squared error of its joint is needed, whatever the doubt of its
# coefficient: Stribeck and Coulomb friction are told apart by few slow samples, their sum by all.
NEEDED = 0.2
# A law that is fitted in place of another keeps this part of the share it promised beside it: 1.05 of it on
# measured strain-wave gears, where it is right, 0.8 where friction was Stribeck's and quadratic.
IN_PLACE = 0.9
# Damping ratio of a link on its transmission: soft joints of the practice logs have 0.04 to 0.6, one that stood
# in for a delay on a clean joint of a world 1.1, and raised the error of other motion thirty times.
MOST_DAMPING = 1.0
# What every drive has stays if its value is beyond so many standard errors (several joints are added at once,
# so more than for one) and its torque beyond this part of the noise, see Rules.over_noise.
EVERYDAY_CERTAIN, EVERYDAY_MATERIAL = 4.0, 0.3
# What is beyond its physical bound by more standard errors than this contradicts it: it stays, and is told. On
# a 9 s log of a clean world, friction that drove by chance tripled the error of unseen motion.
BEYOND_CHANCE = 4.0
# Held at its bounds in the end, a law keeps this part of what it took off unbounded: on a clean joint of a
# world, friction that drove in one direction and braked in the other kept 0.6; chance costs it far less.
WITHIN_BOUNDS = 0.8
# A law of the whole arm that is tried in the place of those of joints is hardly chance by itself, at the usual
# level: what it then leaves of all joints decides. A payload that was right had 0.002, a zero 0.02.
ASKED_ALONE = 0.05
# Of those a law is not fitted that leaves so many times what the several leave of its joint to first order: of
# 36 fits on a measured arm with nothing declared none came below 0.7 of what first order had said, and none did
# as well, for a third of the whole time.
FAR_MORE = 4.0
# Beside constant torques in its time a load has this chance at most: drifts and noise with a memory had 0.16
# and 0.18, loads of 75 g to 1.5 kg on an arm of three joints 2e-2 to 1e-20.
CARRIED = 0.05
# A law that was chosen anew may leave this much more of a joint's squared error.
PRICE = 1.02
# A simpler model may leave more by the square of two standard errors for each parameter it saves.
SAVED = 4.0
# A change may be below its lower bound, often zero, and must differ from zero, by this many standard errors.
CHANGE_DOUBT = 2.0

# A rival that leaves no more than this part of the squared error that the chosen law leaves takes its place. By
# one log, on which a tilt beside a soft base left 0.31 of what a crosstalk did: rivals gain alike to a few
# percent before they are fitted, and what differs by a half afterwards is another model.
AT_MOST_HALF = 0.5

# --- Whether an addition survives on other motion ------------------------------------------------------------
# An error may grow by so much, where it is above so many times the noise; and has to fall to this share on
# the effect's own joint: half of what a fifth of the squared error (Rules.share) is worth.
HARM, ABOVE_NOISE, GAIN = 1.05, 1.2, 0.95
# Stretches of time that a log is cut into, each predicted by the others; a cut tells something where that
# leaves less than so many times the error of the fit. On a measured log of the TX40 laws that lower the error
# of time not fitted at all left 0.26 to 0.96 of their joint's error in every such cut, others up to 1.13.
STRETCHES, PREDICTABLE = (2, 3, 4), 2.0
# What raises the error in one cut is right all the same where that of all cuts together falls to this part: a
# joint's viscous friction had 0.61 beside a spring that was missing. On the TX40 that changes nothing.
IN_ALL_CUTS = 0.75
# Of a law whose torque depends on time a stretch may be all that tells it: friction that changed before half of
# a log was taken back since the second half does not know by how much. A cut decides where its other stretches
# hold this part of what the log tells of the law.
KNOWN = 0.05
# A stretch of another log in which the squared error of both models is so many times that of most stretches
# holds an event that neither has. The declared models of 20 practice logs without one leave up to 18 times in
# one of twenty stretches (a coupling that shows in one move), a contact 36 to 700 times, by joint. A smaller
# one hides little: what lowers all other errors by a tenth is hidden by 180 times.
EVENTFUL = 30.0
# While more is missing, a joint's error may grow by so much; what does so in the end is taken back.
HARM_ON_THE_WAY = 1.5
# In regions held out of one log a joint's error may rise where that is a smaller part of what those of others
# fall by, squared and in units of their noise. In a world of Pinocchio's dynamics a true spring took its joint
# from 42 to 20 times the noise and raised another from 8 to 16 in a region with a third of the log: 0.13 of it.
# On other motion it lowered both, 77 to 18 and 11 to 7; refused, it had three false names in its place.
OUTWEIGHED = 0.25

# What gained more than this part of the first change might have been it, and so many of such are tried. A load
# of a slide gained 0.98 of its drive's gain, beside which springs and friction stood in for the rest.
FIRST_NEAR, FIRST_TRIED = 0.95, 3

# --- Formulas ------------------------------------------------------------------------------------------------
# A formula reaches at least this part of what a smooth function of one or two variables explains.
OF_SMOOTH = 0.8
# Share of the joint's squared error that it may leave in regions it was not fitted to: more right than wrong.
MOST_LEFT = 0.5
# A formula takes the place of named laws, or of a sign of another width, where it leaves this part of what they
# do: what is known by name is preferred to what fits a little better.
CLEARLY_LESS = 0.9
# Formulas whose errors differ by fewer standard errors than this, or by less than this part, fit alike.
FORMULA_TIE, FORMULA_NEAR = 2.0, 1.2
