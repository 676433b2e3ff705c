# python -m build --wheel && docker build -t eyas .
# docker run --rm -v "$PWD/runs:/home/eyas/runs" eyas video --out runs/first
#
# Make `runs` first and pass `--user "$(id -u)"` if it is not the container's user who owns it.
# It has not been built where it was written. Packages alone take 430 MB, 172 MB of them llvmlite.
FROM python:3.13-slim
RUN useradd --create-home eyas
COPY dist/*.whl /tmp/wheels/
RUN pip install --no-cache-dir /tmp/wheels/*.whl \
 && rm -rf /tmp/wheels \
 && find /usr/local/lib/python3.13/site-packages -type d -name tests -prune -exec rm -rf {} +
USER eyas
WORKDIR /home/eyas
ENTRYPOINT ["eyas"]
CMD ["--help"]
