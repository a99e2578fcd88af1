#!/bin/sh
# Computes a chunk, or several: chunk.sh K or chunk.sh A..B. Code 75 is tried again.
try=1
while :; do
    code=0
    steradian chunk @JOB@ "$1" --quiet || code=$?
    [ "$code" = 75 ] && [ "$try" -lt @TRIES@ ] || exit "$code"
    try=$((try + 1))
done
