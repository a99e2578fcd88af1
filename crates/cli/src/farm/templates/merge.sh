#!/bin/sh
# Puts the chunks together.
exec @MERGE@
