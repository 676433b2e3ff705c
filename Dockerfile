# docker build -t eyas .
# docker run --rm -v "$PWD/runs:/home/eyas/runs" eyas video --out runs/first
FROM python:3.13-slim AS build
WORKDIR /src
COPY . .
RUN pip install --no-cache-dir build && python -m build --wheel --outdir /wheels

FROM python:3.13-slim
RUN useradd --create-home eyas
COPY --from=build /wheels /wheels
# Compiled Python and tests of packages are a third of the size.
RUN pip install --no-cache-dir --no-compile /wheels/*.whl && rm -rf /wheels \
 && find /usr/local/lib/python3.13/site-packages -type d -name tests -prune -exec rm -rf {} +
USER eyas
WORKDIR /home/eyas
ENV PYTHONDONTWRITEBYTECODE=1
ENTRYPOINT ["eyas"]
CMD ["--help"]
