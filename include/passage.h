/* How an event of system.xml is triggered. */
#ifndef PASSAGE_H
#define PASSAGE_H

/* The change that triggers an event. */
enum Passage {
  PASSAGE_HOLDS, /* its condition becomes true */
  PASSAGE_RISES, /* its expression crosses 0 upwards */
  PASSAGE_FALLS,
  PASSAGE_BOTH,   /* in either direction */
  PASSAGE_SAMPLES /* at the times of a <sample> */
};

#endif
