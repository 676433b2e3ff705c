// The page in Chinese, see words.js. Keys with `{}` are tried in this order.

export const CHINESE = {
  "Eyas: fly it": "Eyas：亲自飞行",
  Flight: "飞行", Settings: "设置", Close: "关闭", Keys: "按键", "Keys (?)": "按键 (?)",

  // The stage.
  "Picture of the camera": "相机画面", Map: "地图", Weather: "天气", View: "视角",
  Camera: "相机", Behind: "后方", Above: "上方", Overlay: "叠加层",
  "The drone's camera (1)": "无人机的相机 (1)", "From behind (2)": "从后方看 (2)", "From above (3)": "从上方看 (3)",
  "Show view and rewarded range (o)": "显示视野和奖励范围 (o)", reward: "奖励",
  "Map with drone and traffic": "无人机与车流的地图", "Flight controls": "飞行控制",
  Climb: "上升", Sink: "下降", "Rotate left": "左转", "Rotate right": "右转",
  "Camera up": "相机向上", "Camera down": "相机向下", "Camera left": "相机向左", "Camera right": "相机向右",
  "Centre the camera": "相机居中", Forward: "前进", Back: "后退", Left: "向左", Right: "向右",
  "Another page flies.": "另一个页面正在飞行。", "Take the controls": "接管控制",
  "{} m up · {} m/s": "高度 {} 米 · {} 米/秒", "key to picture {} ms": "按键到画面 {} 毫秒",
  "{} flies: press a key to take over": "{} 正在飞行：按任意键接管",
  "A film of {}: {} s left": "{} 的影片：还剩 {} 秒",

  // Who flies.
  "You against it: 60 s": "与它对决：60 秒", "Let it fly": "让它飞", "Give up": "放弃",
  "A policy flies (f); any key takes over": "由策略飞行 (f)；按任意键接管",
  "Who flies": "飞行策略", Film: "影片", "Make a film": "制作影片", "Link of a film": "影片链接",
  "A minute of this policy in this world, with a link by which anybody sees the same pictures":
    "该策略在当前世界中飞行一分钟，任何人都能用链接看到完全相同的画面",
  "Paste the link of a film, and press Enter": "粘贴影片链接并按回车",
  "Copy the link": "复制链接", Copy: "复制", Copied: "已复制",
  "Digest of all pictures: {}, as eyas replay prints it": "全部画面的摘要：{}，与 eyas replay 打印的相同",
  "Best flights here": "此处最佳成绩", you: "你", it: "它",
  "Flights in this world, with this tracker and this reward": "在此世界中、使用此飞行器和此奖励的飞行",
  "You win!": "你赢了！", "A draw.": "平局。", "{} wins.": "{} 获胜。",
  "Your turn in {} …": "{} 秒后轮到你 …", "Now {} in {} …": "{1} 秒后由 {0} 飞行 …",
  "{} s left: keep the target in the middle": "还剩 {} 秒：让目标保持在中央",
  "tracker outside": "外部跟踪器", "your own program sees the target": "由你自己的程序识别目标",
  "a policy of yours": "你自己的策略",
  "oracle: flies over the target, whose position it knows at all times": "真值策略：始终知道目标位置，在其上方飞行",
  "pixels: normalised correlation with the target's first picture": "像素：与目标首帧画面的归一化相关",
  "a network, taught to follow what its first box shows, on all six maps in all four conditions":
    "神经网络：跟踪首帧框中的目标，在六张地图、四种条件下训练",
  "a network, taught to follow what its first box shows, as eyas, and steers drones that a flight controller flies":
    "神经网络：与 eyas 相同，并能操纵由飞控驾驶的无人机",
  "a network, taught to follow what words name, among others that look like it":
    "神经网络：在相似物体中跟踪文字所指的目标",
  "a network, taught citystreet by day": "神经网络：在白天的 citystreet 上训练",

  // The panel.
  Pause: "暂停", "Pause (p)": "暂停 (p)", "Go on": "继续", Step: "单步", "One step of 8 ms (.)": "前进 8 毫秒 (.)",
  Slow: "慢放", "Slow motion (m)": "慢动作 (m)", Reset: "复位", "Back over the target (r)": "回到目标上方 (r)",
  Next: "下一个", "Next target (n)": "下一个目标 (n)", Parked: "停放的车", "The parked car (b)": "停放的汽车 (b)",
  Record: "录制", "Record as eyas video does (v)": "像 eyas video 那样录制 (v)", Photo: "拍照", "Save the picture (x)": "保存画面 (x)",
  Reward: "奖励", "Rewards of the last 20 seconds": "最近 20 秒的奖励", "{} s ago": "{} 秒前", now: "现在",
  view: "视野", distance: "距离", "view, steps": "视野（分级）", "distance, steps": "距离（分级）",
  continuous: "连续", discrete: "离散",
  World: "世界", Target: "目标", Tracker: "飞行器", drone: "无人机", "drone with physics": "带动力学的无人机", car: "汽车",
  "Time of day": "时刻", Light: "光照", Traffic: "车流", "People around": "周围的行人", none: "无", "{} cars": "{} 辆车",
  "by the weather": "随天气", bright: "明亮", dim: "昏暗", dark: "黑暗", "{} h": "{} 时",
  State: "状态", "how central": "居中程度", offset: "水平偏移", height: "高度", speed: "速度", climb: "爬升",
  "yaw rate": "偏航角速度", camera: "相机", target: "目标", model: "型号", "its speed": "目标速度", time: "时间",
  "A training episode would end:": "训练回合会结束：", "A training episode would go on.": "训练回合会继续。",
  "too low or too high": "过低或过高", "too far from its commands": "偏离指令过远", "too fast": "过快",
  "turns too fast": "转动过快", "tilts too far": "倾斜过大", "target has left": "目标已离开",
  "no reward for too long": "太久没有奖励", "number of steps reached": "已到步数上限", "not a number": "非数值",
  "Reward settings": "奖励设置", Type: "类型", Mode: "模式", "Save as env_config.json": "保存为 env_config.json",
  "People around and the time of day are not saved: the DAT benchmark has no keys for them.":
    "周围的行人和时刻不会保存：DAT 基准没有对应的键。",
  Pictures: "画面", "Coding of the pictures": "画面编码", automatic: "自动", "always JPEG": "始终 JPEG", "always H.264": "始终 H.264",
  "{}, {} kB each, {} kB/s": "{}，每帧 {} kB，{} kB/秒", "This browser does not decode H.264 here": "此浏览器在这里不能解码 H.264",
  "This browser cannot decode our H.264; pictures go on as JPEG.": "此浏览器不能解码 H.264；画面改用 JPEG。",
  "For the leaderboard": "排行榜", Protocol: "协议", Begin: "开始",
  "Fly the episodes of a protocol, each once, as a policy would: what a person reaches, beside what policies reach.":
    "像策略那样飞行协议的各个回合，每个一次：把人的成绩与策略的成绩并列。",

  // What the server says.
  "Building {}, {}: {} s": "正在构建 {}，{}：{} 秒", "; new worlds take up to a minute, known ones seconds": "；新世界最多一分钟，已有的几秒钟",
  "No connection to eyas demo; trying again …": "与 eyas demo 的连接已断开；正在重试 …",
  "Recording into {}.": "正在录制到 {}。", "Recorded {} frames in {}.": "已在 {1} 中录制 {0} 帧。",
  "You against {}: begins in the new world.": "与 {} 对决：将在新世界中开始。",
  "All flights are recorded, in {}.": "所有飞行都已录制在 {} 中。",
  "a flight against a policy goes on; give it up first": "对决正在进行；请先放弃",
  "message: another page flies; take the controls first": "另一个页面正在飞行；请先接管控制",

  // Keys.
  "Fly it": "亲自飞行", "forward, back": "前进、后退", "camera up, down": "相机上、下", "rotate left, right": "左转、右转",
  "camera left, right": "相机左、右", "climb, sink": "上升、下降", "centre the camera": "相机居中", "slide left, right": "左移、右移",
  overlay: "叠加层", click: "单击", "follow what is clicked: car, person, robot": "跟踪所单击的：汽车、行人、机器人",
  "camera, behind, above": "相机、后方、上方", "next target, parked car": "下一个目标、停放的车", "pause, step, slow motion": "暂停、单步、慢动作",
  "let it fly": "让它飞", "reset, record, photo": "复位、录制、拍照",
  "Hold several keys at once. A gamepad works too: left stick climbs and rotates, right stick flies, the cross turns the camera.":
    "可同时按住多个键。也支持手柄：左摇杆升降和旋转，右摇杆飞行，十字键转动相机。",
  "Keep the target in the middle of the blue view: only inside the inner area, red to green, is there a reward.":
    "让目标保持在蓝色视野中央：只有在内部区域（红到绿）才有奖励。",

  // Flights for the leaderboard.
  "Eyas: flights for the leaderboard": "Eyas：排行榜飞行", "Flights for ‘{}’": "协议“{}”的飞行", "Connecting …": "正在连接 …",
  "Leave this flight": "离开此次飞行", "The flight counts as far as it was flown": "飞行按已飞的部分计分",
  "Who flies (a name or a number)": "飞行者（姓名或编号）", With: "使用", keyboard: "键盘", gamepad: "手柄", touch: "触屏",
  "Begin (Enter)": "开始（回车）", "Back to free flight": "返回自由飞行", "Another page has the controls.": "另一个页面正在控制。",
  "Up, down: forward, back. Left, right: rotate. Shift + up, down: climb, sink. Shift + left, right: slide. Where the camera turns: W, S, A, D. Keep the target that the box shows in the middle. A flight counts from the moment it begins, also if it is left.":
    "上、下：前进、后退。左、右：旋转。Shift + 上、下：上升、下降。Shift + 左、右：平移。相机可转动时：W、S、A、D。让框中的目标保持在中央。飞行从开始的那一刻起计分，中途离开也算。",
  "Flight {} of {} is being made …": "正在准备第 {} 次飞行，共 {} 次 …", "The flights are being made …": "正在准备飞行 …",
  "Flight {} of {}, {}.": "第 {} 次飞行，共 {} 次，{}。",

  // Worlds.
  day: "白天", night: "夜晚", foggy: "雾", snow: "雪", rain: "雨", dusk: "黄昏", overcast: "阴天", dust: "沙尘", autumn: "秋天",
  "Mid-rise city blocks with rows of great trees": "中层街区与成排大树", "Dunes, and roads under sand": "沙丘与沙下的道路",
  "The roads of the desert on bare sand, without scenery": "沙漠道路，无景物", "Canyons between towers, and a park": "高楼峡谷与公园",
  "A patchwork of fields in four colours": "四色田野", "The roads of the farmland on bare soil, without scenery": "农田道路，无景物",
  "A suburb between ponds and strips of forest": "池塘与林带间的郊区", "A green valley with hills and tunnels": "有山丘和隧道的绿谷",
  "The roads of the village on bare grass, without scenery": "村庄道路，无景物",
  "Straight roads on a white plain": "白色平原上的直路", "Straight roads on a grey plain": "灰色平原上的直路",
  "Straight roads on a lawn": "草地上的直路", "Straight roads on a green plain": "绿色平原上的直路",
  "Straight roads under bars of sand": "沙带下的直路", "Straight roads between coloured strips": "彩色条带间的直路",
  "Straight roads between strips of water": "水带间的直路",
};

// Targets in words.
export const TARGETS = {
  "cars and more": "汽车和其他车辆", people: "行人", custom: "设置中的目标",
  "a blue robot rover on six wheels": "蓝色六轮机器人", "a white disc-shaped robot": "白色圆盘机器人",
  "a gold robot rover under a solar panel": "太阳能板下的金色漫游车", "a dark grey walking machine on six legs": "深灰色六足步行机",
  "a white and orange robot that rolls on a ball": "白橙色球形机器人", "a white robot puppy with a black face": "黑脸白色机器小狗",
  "a robot dog of black motors and grey brackets": "黑色电机灰色支架的机器狗", "a round salmon robot on blue wheels": "蓝轮鲑红色圆形机器人",
  "a red and magenta robot walker with a grey head": "灰头红紫色步行机器人", "a white robot dog with red feet": "红足白色机器狗",
  "a silver humanoid robot with a blue head": "蓝头银色人形机器人", "a grey drone": "灰色无人机",
  black: "黑色", "dark grey": "深灰色", grey: "灰色", white: "白色", "dark red": "暗红色", red: "红色", pink: "粉色", magenta: "洋红色",
  brown: "棕色", orange: "橙色", ochre: "赭色", beige: "米色", yellow: "黄色", olive: "橄榄色", green: "绿色", "light green": "浅绿色",
  "dark green": "深绿色", teal: "青绿色", "sky blue": "天蓝色", blue: "蓝色", "dark blue": "深蓝色", purple: "紫色",
  "a small {} car": "{}小汽车",
  "a {} Mercedes Sprinter van": "{}奔驰厢式车", "a {} truck without a trailer": "{}无挂卡车", "a {} truck with a box trailer": "{}厢式挂车",
  "a {} truck with a tank trailer": "{}罐式挂车",
  "a pedestrian in a {} down jacket": "穿{}羽绒服的行人", "a pedestrian in an {} down jacket": "穿{}羽绒服的行人",
  "a pedestrian in a {}": "穿{}的行人", "a pedestrian in an {}": "穿{}的行人",
  "a cyclist in a {} jacket": "穿{}夹克的骑车人", "a cyclist in an {} jacket": "穿{}夹克的骑车人",
  "a {}": "{}", "an {}": "{}",
  "{} hatchback": "{}掀背车", "{} sedan": "{}轿车", "{} SUV": "{}越野车", "{} van": "{}厢式车", "{} bus": "{}公交车", "{} truck": "{}卡车",
  "{} scooter": "{}踏板摩托车", "{} motorbike": "{}摩托车", "{} motorcycle": "{}摩托车", "{} car": "{}汽车", "{} bird": "{}鸟",
  "{} T-shirt": "{}T恤", "{} shirt": "{}衬衫", "{} jacket": "{}夹克", "{} hoodie": "{}连帽衫", "{} dress": "{}连衣裙", "{} coat": "{}大衣",
};
