// What headers.h is precompiled with.
