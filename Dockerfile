# python -m build --wheel && docker build -t eyas .
# docker run --rm -v "$PWD/runs:/home/eyas/runs" eyas video --out runs/first
#
# Make `runs` first and pass `--user "$(id -u)"` if it is not the container's user who owns it.
# Where it was written no daemon of Docker runs: its steps were replayed by hand, in a root folder of
# Debian with Python 3.13. What only compilers and type checkers read is left out. The extra `video`,
# for MP4, would add 72 MB.
FROM python:3.13-slim AS packages
RUN apt-get update && apt-get install -y --no-install-recommends binutils
COPY dist/*.whl /tmp/wheels/
RUN pip install --no-cache-dir --prefix=/packages /tmp/wheels/*.whl \
 && find /packages -type d -name tests -prune -exec rm -rf {} + \
 && find /packages -type f -regex '.*\.\(pyi\|pxd\|h\|a\|c\|cpp\)' -delete \
 && find /packages -type f -name '*.so*' -exec strip --strip-unneeded {} +
FROM python:3.13-slim
RUN useradd --create-home eyas
COPY --from=packages /packages /usr/local
USER eyas
WORKDIR /home/eyas
ENTRYPOINT ["eyas"]
CMD ["--help"]
