# Copyright (c) 2026, The ARCGym Developers.
# SPDX-License-Identifier: BSD-3-Clause
#
# docker build -t arcgym .
# docker run --rm --gpus all -v arcgym-cache:/cache arcgym train --task ARC-Sigmoid-Magnetic --device cuda:0
#
# The NVIDIA driver comes from the host (NVIDIA Container Toolkit). Warp compiles for the GPU itself, so that no CUDA
# image is needed; Warp's and torch's wheels bring their libraries.
FROM python:3.11-slim

ENV PIP_NO_CACHE_DIR=1 PYTHONUNBUFFERED=1 \
    WARP_CACHE_PATH=/cache/warp ARCGYM_CACHE=/cache/arcgym \
    NVIDIA_VISIBLE_DEVICES=all NVIDIA_DRIVER_CAPABILITIES=compute,utility

WORKDIR /opt/arcgym
COPY pyproject.toml constraints.txt README.md LICENSE ./
COPY source source
COPY assets assets
RUN pip install -c constraints.txt "."

WORKDIR /work
VOLUME /cache
ENTRYPOINT ["arcgym"]
CMD ["list"]
