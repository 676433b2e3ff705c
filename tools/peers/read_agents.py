"""LeRobot learns from an export for a few steps, and Eyas flies what it has learned; then a model
of `transformers` with random weights flies, whatever it writes.

    python tools/peers/read_agents.py RECORDING [STEPS]

It needs both packages and Eyas in one environment.
"""

import json
import os
import subprocess
import sys
from pathlib import Path

os.environ["HF_HUB_OFFLINE"] = "1"

import transformers
from lerobot.scripts.lerobot_train import main as lerobot_train
from tokenizers import Tokenizer
from tokenizers.models import WordLevel
from tokenizers.pre_tokenizers import Whitespace

WORDS = ["<unk>", "<s>", "</s>", "<image>", "{", "}", "box", "velocity", *"0123456789[],:.-"]
TEMPLATE = (
    "{% for message in messages %}{% for part in message['content'] %}"
    "{{ '<image>' if part['type'] == 'image' else part['text'] }} {% endfor %}{% endfor %}"
)


def learned(recording: Path, out: Path, steps: int) -> Path:
    """Return the folder of a policy that LeRobot has trained on an export."""
    asked = {
        "dataset.repo_id": "eyas/check",
        "dataset.root": recording / "exports" / "lerobot",
        "dataset.video_backend": "torchcodec",
        "policy.type": "act",
        "policy.device": "cpu",
        "policy.push_to_hub": "false",
        "policy.pretrained_backbone_weights": "null",
        "policy.dim_model": 128,
        "policy.n_encoder_layers": 2,
        "policy.dim_feedforward": 512,
        "policy.use_vae": "false",
        "policy.chunk_size": 5,
        "policy.n_action_steps": 2,
        "policy.optimizer_lr": 1e-4,
        "policy.optimizer_lr_backbone": 1e-4,
        "steps": steps,
        "batch_size": 16,
        "num_workers": 0,
        "log_freq": 50,
        "save_freq": steps,
        "output_dir": out,
    }
    sys.argv = ["lerobot-train", *(f"--{name}={value}" for name, value in asked.items())]
    lerobot_train()
    return out / "checkpoints" / "last" / "pretrained_model"


def random_model(folder: Path) -> Path:
    """Save a small model of language and vision with random weights; return its folder."""
    tokens = Tokenizer(WordLevel({word: n for n, word in enumerate(WORDS)}, unk_token="<unk>"))
    tokens.pre_tokenizer = Whitespace()
    tokenizer = transformers.PreTrainedTokenizerFast(
        tokenizer_object=tokens, unk_token="<unk>", bos_token="<s>", eos_token="</s>",
        pad_token="</s>", additional_special_tokens=["<image>"],
        model_input_names=["input_ids", "attention_mask"],
    )  # fmt: skip
    picture = {"height": 32, "width": 32}
    processor = transformers.LlavaProcessor(
        transformers.CLIPImageProcessor(size=picture, crop_size=picture, do_center_crop=False),
        tokenizer, patch_size=8, vision_feature_select_strategy="full", chat_template=TEMPLATE,
        image_token="<image>", num_additional_image_tokens=1,
    )  # fmt: skip
    sides = {"hidden_size": 32, "intermediate_size": 64, "num_hidden_layers": 2}
    heads = {"num_attention_heads": 2}
    transformers.set_seed(0)
    config = transformers.LlavaConfig(
        vision_config=transformers.CLIPVisionConfig(image_size=32, patch_size=8, **sides, **heads),
        text_config=transformers.LlamaConfig(vocab_size=len(WORDS), **sides, **heads),
        image_token_index=WORDS.index("<image>"), vision_feature_select_strategy="full",
    )  # fmt: skip
    transformers.LlavaForConditionalGeneration(config).save_pretrained(folder)
    processor.save_pretrained(folder)
    return folder


def flown(agent: dict[str, object], folder: Path, name: str) -> None:
    """Fly an agent in two episodes of `referring`; every flight has to reach its end."""
    path, out = folder / f"{name}.json", folder / f"flown-{name}"
    path.write_text(json.dumps(agent))
    eyas = [sys.executable, "-m", "eyas", "evaluate", "--policy", str(path)]
    asked = ["--protocol", "referring", "--episodes", "1", "--overwrite", "--out", str(out)]
    subprocess.run([*eyas, *asked], check=True)
    records = [json.loads(line) for line in (out / "episodes.jsonl").read_text().splitlines()]
    assert records
    assert not any(record["error"] for record in records), [each["error"] for each in records]


recording = Path(sys.argv[1])
place = recording.parent / "agents"
place.mkdir(exist_ok=True)
policy = learned(recording, place / "act", int(sys.argv[2]) if len(sys.argv) > 2 else 20)
flown({"lerobot": str(policy), "rate": 10.0, "latency": 0.1}, place, "act")
model = random_model(place / "random")
asked = {"most_tokens": 8, "rate": 0.5, "latency": 0.5, "size": [64, 48]}
flown({"transformers": str(model), **asked}, place, "random")
print("agents: LeRobot and transformers fly")
