/* How an event of system.xml comes to happen. */
#ifndef PASSAGE_H
#define PASSAGE_H

enum Passage {
  PASSAGE_HOLDS, /* its condition comes to hold */
  PASSAGE_RISES, /* its expression comes from below 0 to above it */
  PASSAGE_FALLS,
  PASSAGE_BOTH,   /* either way */
  PASSAGE_SAMPLES /* the time of a <sample> has come */
};

#endif
